//! Fetches what the page takes from npm, where there is npm; without it the page is told so and draws by itself.
//!
//! Builds again when a file of the page is added or taken away; changes within files are seen without this.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::{env, fs, io};

fn main() {
    println!("cargo::rerun-if-changed=../../web");
    println!("cargo::rerun-if-env-changed=CARGO_NET_OFFLINE");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo gives build scripts OUT_DIR"));
    let (script, style) =
        fetched(&out).unwrap_or_else(|_| ("export default null;\n".to_owned(), String::new()));
    fs::write(out.join("uplot.js"), script).expect("OUT_DIR can be written to");
    fs::write(out.join("uplot.css"), style).expect("OUT_DIR can be written to");
}

/// uPlot as a module under its licence, and its style sheet: of the version that web/package-lock.json names, by its
/// digest.
fn fetched(out: &Path) -> io::Result<(String, String)> {
    let place = out.join("npm");
    fs::create_dir_all(&place)?;
    for file in ["package.json", "package-lock.json"] {
        fs::copy(Path::new("../../web").join(file), place.join(file))?;
    }
    let mut npm = Command::new("npm");
    npm.args(["ci", "--ignore-scripts", "--no-audit", "--no-fund", "--prefer-offline"])
        .args(["--fetch-retries=0", "--fetch-timeout=20000"])
        .current_dir(&place)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null());
    if env::var("CARGO_NET_OFFLINE").is_ok_and(|offline| offline == "true") {
        npm.arg("--offline");
    }
    if !npm.status()?.success() {
        return Err(io::ErrorKind::NotFound.into());
    }
    let package = place.join("node_modules/uplot");
    let dist = package.join("dist");
    let licence = fs::read_to_string(package.join("LICENSE"))?;
    let script = fs::read_to_string(dist.join("uPlot.iife.min.js"))?;
    let style = fs::read_to_string(dist.join("uPlot.min.css"))?;
    Ok((format!("/*!\n{licence}*/\n{script}\nexport default uPlot;\n"), style))
}
