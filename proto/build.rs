//! Compiles the .proto files without an installed protoc: Rust types through prost, and the descriptor set that
//! recordings carry so that any reader can decode them.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::{env, fs};

use prost::Message;

const INCLUDE: &str = ".";
const PACKAGE: &str = "waymark/v1";

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo:rerun-if-changed={PACKAGE}");
    let mut compiler = protox::Compiler::new([INCLUDE])?;
    compiler.include_imports(true).include_source_info(true).open_files(proto_files()?)?;
    let mut descriptors = compiler.file_descriptor_set();
    prost_build::Config::new().enable_type_names().compile_fds(descriptors.clone())?;

    // Comments serve the generated documentation; recordings need only the structure.
    for file in &mut descriptors.file {
        file.source_code_info = None;
    }
    let out_dir = PathBuf::from(env::var("OUT_DIR")?);
    fs::write(out_dir.join("waymark.v1.descriptors"), descriptors.encode_to_vec())?;
    Ok(())
}

fn proto_files() -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(Path::new(INCLUDE).join(PACKAGE))? {
        let name = entry?.file_name();
        if Path::new(&name).extension().is_some_and(|extension| extension == "proto") {
            files.push(Path::new(PACKAGE).join(name));
        }
    }
    files.sort();
    Ok(files)
}
