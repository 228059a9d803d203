//! The bundles that a writer is given for the order `explicit`.

use super::{EncodeError, EncodeOptions, GridSource};
use crate::directory::{Directory, Entry};
use crate::encoding::Order;
use crate::order::explicit::list_len;
use alloc::vec;
use alloc::vec::Vec;

/// The vertices of each bundle, ascending.
pub(super) struct Lists(Vec<Vec<u64>>);

impl Lists {
    /// The bundles of the source, none where the order needs no lists.
    pub(super) fn of(source: &GridSource<'_>, order: Order, most: u64) -> Result<Self, EncodeError> {
        let given = match (order, source.bundles) {
            (Order::Explicit, Some(given)) => given,
            (Order::Explicit, None) => return Err(EncodeError::BundlesMissing),
            (_, None) => return Ok(Self(Vec::new())),
            (_, Some(_)) => return Err(EncodeError::BundlesUnwanted { order }),
        };
        let lattice = &source.lattice;
        let count = lattice.vertex_count();
        // The source holds values of every vertex, so the count is one of memory.
        let mut taken = vec![false; count as usize];
        let mut lists = Vec::with_capacity(given.len());
        for (bundle, vertices) in given.iter().enumerate() {
            if vertices.is_empty() {
                return Err(EncodeError::BundleEmpty { bundle });
            }
            if vertices.len() as u64 > most {
                return Err(EncodeError::BundleTooLarge { bundle, found: vertices.len(), most });
            }
            for &vertex in vertices {
                if vertex >= count {
                    return Err(EncodeError::VertexOutside { bundle, vertex });
                }
                if lattice.is_corner(vertex) {
                    return Err(EncodeError::VertexIsCorner { bundle, vertex: lattice.coords(vertex) });
                }
                if core::mem::replace(&mut taken[vertex as usize], true) {
                    return Err(EncodeError::VertexTwice { bundle, vertex: lattice.coords(vertex) });
                }
            }
            let mut list = vertices.clone();
            list.sort_unstable();
            lists.push(list);
        }
        let is_valid = |vertex: u64| source.validity.is_none_or(|all| all[vertex as usize] != 0);
        let missing =
            |&vertex: &u64| !taken[vertex as usize] && is_valid(vertex) && !lattice.is_corner(vertex);
        match (0..count).find(missing) {
            Some(vertex) => Err(EncodeError::VertexMissing { vertex: lattice.coords(vertex) }),
            None => Ok(Self(lists)),
        }
    }

    /// Number of bundles.
    pub(super) const fn len(&self) -> usize {
        self.0.len()
    }

    /// The vertices of bundle `k`, counted from 1.
    pub(super) fn get(&self, k: u32) -> &[u64] {
        &self.0[k as usize - 1]
    }

    /// What the directory says of these bundles.
    pub(super) fn directory(&self, options: &EncodeOptions) -> Result<Directory, EncodeError> {
        let mut entries = Vec::with_capacity(self.0.len());
        for list in &self.0 {
            let vertices = u32::try_from(list.len()).map_err(|_| EncodeError::BundleSize)?;
            let index_bytes =
                u32::try_from(list_len(list.iter().copied())).map_err(|_| EncodeError::BundleSize)?;
            entries.push(Entry::new(vertices, index_bytes));
        }
        Ok(Directory::of(entries.into_iter(), options.encoding.bytes_per_vertex()))
    }
}
