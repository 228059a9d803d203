//! Reading accessors: any component type, normalised or not, strided, sparse; every range checked.

use std::borrow::Cow;
use std::cell::OnceCell;

use ::gltf::json::Root;
use ::gltf::json::accessor::{ComponentType, Type};
use ::gltf::json::validation::Checked;

use super::buffers::{self, Buffers};
use crate::SceneError;

/// The document with its buffers; compressed views are decoded once, when first read.
pub(super) struct Data<'a> {
    pub(super) name: &'a str,
    pub(super) root: &'a Root,
    buffers: Buffers<'a>,
    decoded: Vec<OnceCell<Vec<u8>>>,
}

/// Where the values of an accessor lie.
struct Layout {
    view: usize,
    offset: usize,
    stride: usize,
    count: usize,
    component: ComponentType,
    components: usize,
    normalized: bool,
}

impl<'a> Data<'a> {
    pub(super) fn new(name: &'a str, root: &'a Root, buffers: Buffers<'a>) -> Self {
        let decoded = root.buffer_views.iter().map(|_| OnceCell::new()).collect();
        Self { name, root, buffers, decoded }
    }

    pub(super) fn error(&self, what: impl Into<String>) -> SceneError {
        SceneError::file(self.name, what)
    }

    /// The bytes of a buffer view.
    pub(super) fn view(&self, index: usize) -> Result<&[u8], SceneError> {
        let slot = self
            .decoded
            .get(index)
            .ok_or_else(|| self.error(format!("bufferViews[{index}] does not exist")))?;
        if let Some(bytes) = slot.get() {
            return Ok(bytes);
        }
        let bytes = buffers::view(self.root, &self.buffers, index)
            .map_err(|what| self.error(format!("bufferViews[{index}]: {what}")))?;
        match bytes {
            Cow::Borrowed(bytes) => Ok(bytes),
            Cow::Owned(bytes) => Ok(slot.get_or_init(|| bytes)),
        }
    }

    /// The values of an accessor with `N` components, as f32; integers are normalised where the accessor says so.
    pub(super) fn values<const N: usize>(&self, index: usize) -> Result<Vec<[f32; N]>, SceneError> {
        let layout = self.layout(index)?;
        if layout.components != N {
            return Err(
                self.error(format!("accessors[{index}] has {} components instead of {N}", layout.components))
            );
        }
        let convert = |element: &[u8]| floats::<N>(element, layout.component, layout.normalized);
        let mut values: Vec<[f32; N]> = self.elements(index, &layout)?.map(convert).collect();
        for (at, element) in self.sparse(index, &layout)? {
            values[at] = convert(element);
        }
        Ok(values)
    }

    /// The values of an accessor of colours, with three components or four: linear RGB and alpha, which is 1 where it is missing.
    pub(super) fn colours(&self, index: usize) -> Result<Vec<[f32; 4]>, SceneError> {
        match self.layout(index)?.components {
            3 => Ok(self.values(index)?.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()),
            _ => self.values(index),
        }
    }

    /// The values of an accessor of vertex indices.
    pub(super) fn indices(&self, index: usize) -> Result<Vec<u32>, SceneError> {
        let layout = self.layout(index)?;
        let integer = matches!(layout.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if layout.components != 1 || !integer {
            return Err(self.error(format!("accessors[{index}] is not a list of unsigned integers")));
        }
        let mut values: Vec<u32> =
            self.elements(index, &layout)?.map(|element| unsigned(element, layout.component)).collect();
        for (at, element) in self.sparse(index, &layout)? {
            values[at] = unsigned(element, layout.component);
        }
        Ok(values)
    }

    fn layout(&self, index: usize) -> Result<Layout, SceneError> {
        let bad = |what: &str| self.error(format!("accessors[{index}]: {what}"));
        let accessor = self.root.accessors.get(index).ok_or_else(|| bad("does not exist"))?;
        let (Checked::Valid(component), Checked::Valid(kind)) = (&accessor.component_type, &accessor.type_)
        else {
            return Err(bad("unknown type"));
        };
        let component = component.0;
        let components = match kind {
            Type::Scalar => 1,
            Type::Vec2 => 2,
            Type::Vec3 => 3,
            Type::Vec4 => 4,
            Type::Mat2 | Type::Mat3 | Type::Mat4 => return Err(bad("matrices are no vertex attribute")),
        };
        let view = accessor
            .buffer_view
            .ok_or_else(|| bad("sparse values without a base are not supported"))?
            .value();
        let stride = self.root.buffer_views.get(view).and_then(|v| v.byte_stride).map_or(0, |s| s.0);
        let size = size_of(component) * components;
        Ok(Layout {
            view,
            offset: usize::try_from(accessor.byte_offset.map_or(0, |o| o.0)).map_err(|_| bad("offset"))?,
            stride: if stride == 0 { size } else { stride },
            count: usize::try_from(accessor.count.0).map_err(|_| bad("count"))?,
            component,
            components,
            normalized: accessor.normalized,
        })
    }

    /// The base values' bytes, one slice an element; their number is known to fit the view.
    fn elements(&self, index: usize, l: &Layout) -> Result<impl Iterator<Item = &[u8]>, SceneError> {
        let size = size_of(l.component) * l.components;
        let bytes = self.slice(l.view, l.offset, l.stride, size, l.count).ok_or_else(|| {
            self.error(format!(
                "accessors[{index}]: {} values of {size} bytes do not fit bufferViews[{}]",
                l.count, l.view
            ))
        })??;
        Ok((0..l.count).map(move |i| &bytes[i * l.stride..i * l.stride + size]))
    }

    /// Bytes of `count` values in a view, or `None` if they do not fit.
    fn slice(
        &self,
        view: usize,
        offset: usize,
        stride: usize,
        size: usize,
        count: usize,
    ) -> Option<Result<&[u8], SceneError>> {
        let bytes = match self.view(view) {
            Ok(bytes) => bytes,
            Err(error) => return Some(Err(error)),
        };
        if count == 0 {
            return Some(Ok(&[]));
        }
        let length = (count - 1).checked_mul(stride)?.checked_add(size)?;
        bytes.get(offset..offset.checked_add(length)?).map(Ok)
    }

    /// Index and bytes of each value that replaces a base value.
    fn sparse(&self, index: usize, l: &Layout) -> Result<Vec<(usize, &[u8])>, SceneError> {
        let Some(sparse) = self.root.accessors.get(index).and_then(|a| a.sparse.as_ref()) else {
            return Ok(Vec::new());
        };
        let bad = || self.error(format!("accessors[{index}]: sparse values do not fit"));
        let Checked::Valid(component) = &sparse.indices.component_type else { return Err(bad()) };
        let component = component.0;
        let count = usize::try_from(sparse.count.0).map_err(|_| bad())?;
        let size = size_of(l.component) * l.components;
        let step = size_of(component);
        let offset = |o: u64| usize::try_from(o).map_err(|_| bad());
        let indices = self
            .slice(
                sparse.indices.buffer_view.value(),
                offset(sparse.indices.byte_offset.0)?,
                step,
                step,
                count,
            )
            .ok_or_else(bad)??;
        let values = self
            .slice(sparse.values.buffer_view.value(), offset(sparse.values.byte_offset.0)?, size, size, count)
            .ok_or_else(bad)??;
        let mut pairs = Vec::new();
        for (at, value) in indices.chunks_exact(step).zip(values.chunks_exact(size)) {
            let at = unsigned(at, component) as usize;
            if at >= l.count {
                return Err(bad());
            }
            pairs.push((at, value));
        }
        Ok(pairs)
    }
}

fn size_of(component: ComponentType) -> usize {
    match component {
        ComponentType::I8 | ComponentType::U8 => 1,
        ComponentType::I16 | ComponentType::U16 => 2,
        ComponentType::U32 | ComponentType::F32 => 4,
    }
}

fn unsigned(b: &[u8], component: ComponentType) -> u32 {
    match component {
        ComponentType::U16 | ComponentType::I16 => u32::from(u16::from_le_bytes([b[0], b[1]])),
        ComponentType::U32 | ComponentType::F32 => u32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        ComponentType::U8 | ComponentType::I8 => u32::from(b[0]),
    }
}

/// Normalisation as in glTF 2.0, section 3.6.2.2.
fn floats<const N: usize>(element: &[u8], component: ComponentType, normalized: bool) -> [f32; N] {
    let size = size_of(component);
    std::array::from_fn(|i| {
        let b = &element[i * size..];
        let (value, one) = match component {
            ComponentType::I8 => (f32::from(b[0] as i8), 127.0),
            ComponentType::U8 => (f32::from(b[0]), 255.0),
            ComponentType::I16 => (f32::from(i16::from_le_bytes([b[0], b[1]])), 32767.0),
            ComponentType::U16 => (f32::from(u16::from_le_bytes([b[0], b[1]])), 65535.0),
            ComponentType::U32 => (u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as f32, 4_294_967_295.0),
            ComponentType::F32 => return f32::from_le_bytes([b[0], b[1], b[2], b[3]]),
        };
        if normalized { (value / one).max(-1.0) } else { value }
    })
}
