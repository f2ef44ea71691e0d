//! The navigation bench: geometry against independent computations, worlds and their faults, campaigns from outside.

mod campaigns;
mod command;
mod contact;
mod figures;
mod generated;
mod pages;
mod promises;
mod ranges;
mod refused;
mod runs;
mod world_files;
