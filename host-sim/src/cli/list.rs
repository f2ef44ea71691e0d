//! `host-sim list`

use super::{BadInput, print};
use clap::Args;
use comfy_table::{Table, presets::NOTHING};
use host_sim::scenario::{BUILT_IN, parse};

#[derive(Args)]
pub struct ListArguments {
    /// Print this built-in scenario's TOML, ready to be copied and changed.
    #[arg(long, value_name = "NAME")]
    show: Option<String>,
}

pub fn execute(arguments: &ListArguments) -> anyhow::Result<()> {
    if let Some(name) = &arguments.show {
        let (_, text) = BUILT_IN
            .iter()
            .find(|(known, _)| known == name)
            .ok_or_else(|| {
                let known: Vec<&str> = BUILT_IN.iter().map(|(known, _)| *known).collect();
                BadInput(format!(
                    "--show {name}: no such built-in scenario; allowed is one of {}",
                    known.join(", ")
                ))
            })?;
        return print(text);
    }
    let mut table = Table::new();
    table.load_style(NOTHING);
    for (name, text) in BUILT_IN {
        table.add_row([*name, parse(name, name, text)?.about.as_str()]);
    }
    print(format_args!("{table}\n"))
}
