//! How much memory the library and its tables take for the experiment's tick: what `with-tick` has and `without-tick`
//! has not.

use crate::machine::{Images, Machine};
use anyhow::Context;
use object::{Object, ObjectSection, SectionKind};
use std::path::Path;

/// Bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// Code, constants and the first values of data.
    pub flash: u32,
    /// Data.
    pub ram: u32,
}

/// The library's.
pub fn library(machine: &Machine, images: &Images) -> anyhow::Result<Footprint> {
    let with = of(&images.of(machine, "with-tick"))?;
    let without = of(&images.of(machine, "without-tick"))?;
    Ok(Footprint {
        flash: with.flash.saturating_sub(without.flash),
        ram: with.ram.saturating_sub(without.ram),
    })
}

/// A whole image's.
pub fn of(image: &Path) -> anyhow::Result<Footprint> {
    let context = || image.display().to_string();
    let bytes = std::fs::read(image).with_context(context)?;
    let file = object::File::parse(&*bytes).with_context(context)?;
    let mut found = Footprint::default();
    for section in file.sections() {
        let size = u32::try_from(section.size())?;
        match section.kind() {
            SectionKind::Text | SectionKind::ReadOnlyData | SectionKind::ReadOnlyString => {
                found.flash += size;
            }
            SectionKind::Data => {
                found.flash += size;
                found.ram += size;
            }
            SectionKind::UninitializedData => found.ram += size,
            _ => {}
        }
    }
    Ok(found)
}
