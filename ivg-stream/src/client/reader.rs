//! Reading files that are at hand whole, by the same machine that takes them from a connection.

use super::assembly::Assembly;
use super::contents::{GridContents, MeshContents};
use super::download::{Arrived, Contents, Download, Refusal};

/// One file of an [`Assembly`] that is being read from its first byte on.
pub(crate) struct FileReader<'a> {
    target: Target<'a>,
    /// Whether the whole file, once it is in, is the stated one.
    matches: Option<bool>,
}

enum Target<'a> {
    Mesh(&'a mut Download<MeshContents>),
    Grid(&'a mut Download<GridContents>),
}

impl Assembly {
    /// A reader for each file.
    pub(crate) fn readers(&mut self) -> impl Iterator<Item = FileReader<'_>> {
        let meshes = self.meshes.iter_mut().map(Target::Mesh);
        let targets = meshes.chain(self.grid.iter_mut().map(Target::Grid));
        targets.map(|target| FileReader { target, matches: None })
    }
}

impl FileReader<'_> {
    /// The file's name in the scene directory.
    pub(crate) fn uri(&self) -> &str {
        match &self.target {
            Target::Mesh(download) => &download.file.uri,
            Target::Grid(download) => &download.file.uri,
        }
    }

    /// Takes the next bytes; says what is wrong with them.
    pub(crate) fn feed(&mut self, bytes: &[u8]) -> Result<(), String> {
        match &mut self.target {
            Target::Mesh(download) => feed(download, bytes, &mut self.matches),
            Target::Grid(download) => feed(download, bytes, &mut self.matches),
        }
    }

    /// Checks that the file was whole and the stated one.
    pub(crate) fn finish(self) -> Result<(), String> {
        match self.matches {
            Some(true) => Ok(()),
            Some(false) => Err("its SHA-256 is not the one that scene.glb states".to_owned()),
            None => Err("it ends too early".to_owned()),
        }
    }
}

fn feed<C: Contents>(
    download: &mut Download<C>,
    bytes: &[u8],
    matches: &mut Option<bool>,
) -> Result<(), String> {
    if download.position() + bytes.len() as u64 > download.file.byte_length {
        return Err(format!(
            "it is longer than the {} bytes that scene.glb states",
            download.file.byte_length
        ));
    }
    let taken = download.receive(bytes, &mut |event| {
        if let Arrived::Complete { matches: same } = event {
            *matches = Some(same);
        }
    });
    taken.map_err(|(Refusal::Damaged(reason) | Refusal::Final(reason))| reason)
}
