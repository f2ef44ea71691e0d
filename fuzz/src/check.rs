//! What must hold of every file: reading it ends without a panic, in an error that can be shown or in a system; and a system
//! that can be written is, once read again, the same; but for its descriptions, which FCL has not.

use host_sim::fuzzy::files::{Format, fcl, fll, parse};

/// Reads `bytes` as `format` and checks all of that.
pub fn check(bytes: &[u8], format: Format) {
    let system = match parse("fuzz", bytes, format) {
        Ok(system) => system.without_places(),
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    for (format, text) in [
        (Format::Fll, fll::write(&system)),
        (Format::Fcl, fcl::write(&system)),
    ] {
        let Ok(text) = text else {
            continue;
        };
        match parse("written", text.as_bytes(), format) {
            Ok(again) if format == Format::Fcl => {
                let said = system.clone().without_descriptions();
                assert_eq!(again.without_places(), said, "{text}");
            }
            Ok(again) => assert_eq!(again.without_places(), system, "{text}"),
            Err(error) => panic!("{error}\n{text}"),
        }
    }
}
