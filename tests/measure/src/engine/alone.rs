//! The image `fine-alone`: the controller's bytes, and what it is linked with.

use crate::footprint;
use crate::machine::{Images, Machine};
use anyhow::{Context, ensure};
use object::{Object, ObjectSymbol, SymbolKind};

/// Parts of the names of routines that compute with floats, divide or panic.
const FOREIGN: [&str; 8] = [
    "__aeabi_f",
    "__aeabi_d",
    "sf2",
    "sf3",
    "df2",
    "df3",
    "div",
    "panic",
];

/// What the panic handler of that image calls, and nobody has written.
const HANDLER: &str = "the_fine_controller_can_panic";

/// Bytes.
#[derive(Clone, Copy, Debug)]
pub struct Alone {
    /// The controller's function, scales and tables.
    pub flash: u32,
    /// Mutable memory of the whole image.
    pub memory: u32,
}

/// Reads the image. That it links says that nothing in it panics.
///
/// # Errors
///
/// A float's, a division's or a panic's routine in it.
pub fn look(machine: &Machine, images: &Images) -> anyhow::Result<Alone> {
    let image = images.of(machine, "fine-alone");
    let bytes = std::fs::read(&image).with_context(|| image.display().to_string())?;
    let file = object::File::parse(&*bytes)?;
    let (mut flash, mut code, mut foreign) = (0, 0, Vec::new());
    for symbol in file.symbols() {
        let name = symbol.name()?;
        let own = name == "fine_controller" || name.contains("CONTROLLER") || name.contains("TWIN");
        if own {
            flash += symbol.size();
        }
        if name == "fine_controller" && symbol.kind() == SymbolKind::Text {
            code = symbol.size();
        }
        if FOREIGN.iter().any(|part| without_hash(name).contains(part)) {
            foreign.push(name);
        }
    }
    ensure!(code > 0, "{}: no controller in the image", machine.name);
    ensure!(
        foreign.is_empty(),
        "{}: linked with {}",
        machine.name,
        foreign.join(", ")
    );
    Ok(Alone {
        flash: u32::try_from(flash)?,
        memory: footprint::of(&image)?.ram,
    })
}

/// A symbol without the hash that rustc ends it with: sixteen digits may spell anything.
fn without_hash(name: &str) -> &str {
    match name.rsplit_once("17h") {
        Some((path, hash)) if hash.len() == 17 && hash.ends_with('E') => path,
        _ => name,
    }
}

/// That the check would tell: with one `unwrap` more the image does not link, and the linker says why.
///
/// # Errors
///
/// It links, or fails for another reason.
pub fn refused(machine: &Machine, images: &Images) -> anyhow::Result<()> {
    let said = images
        .refused(machine, "fine-alone", "one-panic")?
        .with_context(|| format!("{}: an image with an unwrap in it links", machine.name))?;
    ensure!(
        said.contains(HANDLER),
        "{}: the image with an unwrap fails for another reason:\n{said}",
        machine.name
    );
    Ok(())
}
