//! NumPy's file format for arrays, version 1.0.

use std::error::Error;
use std::path::PathBuf;

use vision::methods::Plane;

/// Where arrays are written.
pub(crate) struct Folder(PathBuf);

impl Folder {
    pub(crate) fn new(path: &str) -> Result<Self, Box<dyn Error>> {
        std::fs::create_dir_all(path)?;
        Ok(Self(path.into()))
    }

    /// Writes a plane as `NAME.npy`: rows by columns of little-endian 32-bit floats.
    pub(crate) fn write(&self, name: &str, plane: &Plane) -> Result<(), Box<dyn Error>> {
        let (width, height) = (plane.width(), plane.height());
        let mut header =
            format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}), }}");
        // Magic, version and length take ten bytes; the values begin at a multiple of 64.
        let length = (10 + header.len() + 1).next_multiple_of(64) - 10;
        header.push_str(&" ".repeat(length - 1 - header.len()));
        header.push('\n');
        let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
        bytes.extend((length as u16).to_le_bytes());
        bytes.extend(header.into_bytes());
        bytes.extend(plane.values().iter().flat_map(|value| value.to_le_bytes()));
        Ok(std::fs::write(self.0.join(format!("{name}.npy")), bytes)?)
    }
}
