//! Builds again when a file of the page is added or taken away; changes within files are seen without this.

fn main() {
    println!("cargo::rerun-if-changed=../../web");
}
