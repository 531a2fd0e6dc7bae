//! Tests of the built program and of the library beneath it: one program for all, since each links everything that the command line needs.

mod animation;
mod bad_input;
mod bad_numbers;
mod capture;
mod cloud_look;
mod cloud_readers;
#[cfg(any(feature = "las", feature = "e57"))]
mod cloud_survey_formats;
mod commands;
mod common;
mod compare_page;
#[cfg(feature = "las")]
mod copc;
mod copies;
mod cryptomatte;
mod cube_maps;
mod damaged_pictures;
mod documented_commands;
mod documented_keys;
mod dry_run;
mod flip;
mod gltf;
#[cfg(unix)]
mod interrupts;
mod job;
mod lamps_turned_away;
mod large_clouds;
mod map_places;
mod masks;
mod materials;
mod memory_limits;
mod odd_files;
mod opengl_model;
mod outputs_and_threads;
mod overrides;
mod picture_formats;
mod pipes;
mod plain_models;
mod probe;
mod quick_pictures;
mod radiosity;
mod readers;
mod sample;
mod scan;
mod surfel;
mod what_files_are;
