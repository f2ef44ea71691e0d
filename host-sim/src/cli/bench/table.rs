//! The tables that a bench prints.

use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use host_sim::bench::results::Results;
use host_sim::bench::rows;

/// All that a bench has to say: the controllers, and what was asked for beside them.
pub fn all(results: &[Results]) -> String {
    let mut text = format!("{}\n", printed(&rows::figures(results)));
    if let Some(costs) = rows::costs(results) {
        text += &format!("\nThe same with a sound robot:\n{}\n", printed(&costs));
    }
    for result in results {
        if let Some(dead) = &result.dead_sensors {
            text += &format!(
                "\n{}, one sensor dead:\n{}\n{}\n",
                result.conditions.controller,
                printed(&rows::dead_sensors(dead)),
                rows::worst(dead)
            );
        }
    }
    if let Some(routes) = rows::routes(results) {
        text += &format!("\nDistance from the routes:\n{}\n", printed(&routes));
    }
    text
}

fn printed(rows: &rows::Table) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(rows.headings);
    for row in &rows.rows {
        table.add_row(row.iter().map(|cell| match &cell.interval {
            Some(interval) => format!("{}\n{interval}", cell.text),
            None => cell.text.clone(),
        }));
    }
    table
}
