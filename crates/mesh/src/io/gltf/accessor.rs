//! Accessors: typed arrays inside the buffers, read element by element without trust in any number of the document.

use std::borrow::Cow;

use super::super::error::ReadError;
use super::GltfDocument;
use super::json::Item;

/// The name of the accessors of UVs that [`GltfDocument::set_uvs`] wrote last. A name changes nothing for other programs.
pub(super) const OWN: &str = "abf UVs";

/// The type of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of_code(code: usize) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// What the document calls it.
    pub(super) const fn code(self) -> u32 {
        match self {
            Self::I8 => 5120,
            Self::U8 => 5121,
            Self::I16 => 5122,
            Self::U16 => 5123,
            Self::U32 => 5125,
            Self::F32 => 5126,
        }
    }

    /// Its size in bytes.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number at the beginning of these bytes, of which there are enough.
    fn read(self, bytes: &[u8], normalized: bool) -> f64 {
        let two = |b: &[u8]| [b[0], b[1]];
        let four = |b: &[u8]| [b[0], b[1], b[2], b[3]];
        let (number, scale): (f64, f64) = match self {
            Self::I8 => (f64::from(bytes[0] as i8), i8::MAX.into()),
            Self::U8 => (bytes[0].into(), u8::MAX.into()),
            Self::I16 => (i16::from_le_bytes(two(bytes)).into(), i16::MAX.into()),
            Self::U16 => (u16::from_le_bytes(two(bytes)).into(), u16::MAX.into()),
            Self::U32 => (u32::from_le_bytes(four(bytes)).into(), u32::MAX.into()),
            Self::F32 => return f32::from_le_bytes(four(bytes)).into(),
        };
        // Only the lowest of the signed numbers is beyond −1.
        if normalized { (number / scale).max(-1.0) } else { number }
    }
}

/// How many columns and rows a type has.
fn shape(name: &str) -> Option<(usize, usize)> {
    Some(match name {
        "SCALAR" => (1, 1),
        "VEC2" => (1, 2),
        "VEC3" => (1, 3),
        "VEC4" => (1, 4),
        "MAT2" => (2, 2),
        "MAT3" => (3, 3),
        "MAT4" => (4, 4),
        _ => return None,
    })
}

/// Elements at equal distances.
#[derive(Clone, Copy)]
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl<'a> Strided<'a> {
    fn get(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..][..self.size]
    }
}

/// Elements that replace others.
struct Sparse<'a> {
    /// Which, in ascending order.
    indices: Vec<usize>,
    values: Strided<'a>,
}

/// The elements of one accessor.
pub(super) struct Accessor<'a> {
    item: Item<'a>,
    component: Component,
    normalized: bool,
    columns: usize,
    rows: usize,
    count: usize,
    /// `None` for zeros.
    data: Option<Strided<'a>>,
    sparse: Option<Sparse<'a>>,
}

impl GltfDocument {
    /// The accessor that a field of an object names.
    pub(super) fn accessor<'a>(&'a self, index: usize, from: (&Item<'a>, &str)) -> Result<Accessor<'a>, ReadError> {
        let item = self.root().element("accessors", index, from)?;
        let code = item.required("componentType")?;
        let component = Component::of_code(code)
            .ok_or_else(|| item.fault_at("componentType", format!("{code} is no type of numbers")))?;
        let name = item.text("type").unwrap_or_default();
        let (columns, rows) =
            shape(name).ok_or_else(|| item.fault_at("type", format!("`{name}` is no type of elements")))?;
        let normalized = item.fields().get("normalized").and_then(serde_json::Value::as_bool).unwrap_or(false);
        let count = item.required("count")?;
        let size = element_size(component, columns, rows);
        let data = match item.number("bufferView")? {
            Some(view) => {
                Some(self.strided(&item, view, item.number("byteOffset")?.unwrap_or(0), count, size, true)?)
            }
            None => None,
        };
        if data.is_none() {
            self.check_zeros(&item, count)?;
        }
        let sparse = item.object("sparse")?.map(|sparse| self.sparse(&sparse, count, size)).transpose()?;
        Ok(Accessor { item, component, normalized, columns, rows, count, data, sparse })
    }

    /// An accessor without data is all zeros, as many as it says: no more are believed than there are bytes of anything.
    fn check_zeros(&self, item: &Item<'_>, count: usize) -> Result<(), ReadError> {
        let most = self.buffers().iter().map(|b| b.bytes.len()).sum();
        if count > most {
            let reason = format!("{count} elements without data are claimed, in a document with {most} bytes of data");
            return Err(item.fault_at("count", reason));
        }
        Ok(())
    }

    /// `count` elements of a buffer view, all of which are there.
    fn strided<'a>(
        &'a self,
        item: &Item<'a>,
        view: usize,
        offset: usize,
        count: usize,
        size: usize,
        interleaved: bool,
    ) -> Result<Strided<'a>, ReadError> {
        let view = self.root().element("bufferViews", view, (item, "bufferView"))?;
        let (first, length) = (view.number("byteOffset")?.unwrap_or(0), view.required("byteLength")?);
        let buffer = view.required("buffer")?;
        self.root().element("buffers", buffer, (&view, "buffer"))?;
        let bytes = self.buffers().get(buffer).map_or(&[][..], |b| &b.bytes);
        let within = first.checked_add(length).and_then(|end| bytes.get(first..end));
        let view_bytes = within.ok_or_else(|| {
            view.fault(format!("{length} bytes from {first} on reach beyond the {} of the buffer", bytes.len()))
        })?;
        let stride = if interleaved { view.number("byteStride")?.unwrap_or(size) } else { size };
        if stride < size {
            return Err(view.fault_at("byteStride", format!("{stride} is less than an element of {size} bytes")));
        }
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|n| n.checked_add(size)),
        };
        let end = needed.and_then(|n| n.checked_add(offset));
        let bytes = end.and_then(|end| view_bytes.get(offset..end)).ok_or_else(|| {
            let reach = format!("{count} elements, {stride} bytes apart, from byte {offset} on");
            item.fault(format!("{reach} reach beyond the {length} bytes of the buffer view"))
        })?;
        Ok(Strided { bytes, stride, size })
    }

    fn sparse<'a>(&'a self, sparse: &Item<'a>, count: usize, size: usize) -> Result<Sparse<'a>, ReadError> {
        let replaced = sparse.required("count")?;
        let part = |key: &str| sparse.object(key)?.ok_or_else(|| sparse.fault(format!("`{key}` is missing")));
        let (indices, values) = (part("indices")?, part("values")?);
        let code = indices.required("componentType")?;
        let component = Component::of_code(code)
            .filter(|c| matches!(c, Component::U8 | Component::U16 | Component::U32))
            .ok_or_else(|| indices.fault_at("componentType", format!("{code} is no type of indices")))?;
        let read = |part: &Item<'a>, size| {
            let offset = part.number("byteOffset")?.unwrap_or(0);
            self.strided(part, part.required("bufferView")?, offset, replaced, size, false)
        };
        let bytes = read(&indices, component.size())?;
        let values = read(&values, size)?;
        let list: Vec<usize> = (0..replaced).map(|i| component.read(bytes.get(i), false) as usize).collect();
        if !list.is_sorted_by(|a, b| a < b) || list.last().is_some_and(|&last| last >= count) {
            return Err(indices.fault(format!("the indices are not ascending numbers below {count}")));
        }
        Ok(Sparse { indices: list, values })
    }
}

/// The size of an element; columns of matrices begin at multiples of four bytes.
fn element_size(component: Component, columns: usize, rows: usize) -> usize {
    let column = rows * component.size();
    if columns == 1 { column } else { columns * column.next_multiple_of(4) }
}

impl<'a> Accessor<'a> {
    /// How many elements there are.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The type of the numbers.
    pub(super) fn component(&self) -> Component {
        self.component
    }

    /// The object in the document.
    pub(super) fn item(&self) -> &Item<'a> {
        &self.item
    }

    /// The size of an element in bytes.
    pub(super) fn size(&self) -> usize {
        element_size(self.component, self.columns, self.rows)
    }

    /// Whether all elements that nothing replaces are zeros of which there is no data.
    pub(super) fn has_data(&self) -> bool {
        self.data.is_some()
    }

    /// The bytes of an element.
    ///
    /// # Panics
    /// If there are not so many elements.
    pub(super) fn element(&self, i: usize) -> Cow<'a, [u8]> {
        assert!(i < self.count, "element {i} of {}", self.count);
        let replaced = self.sparse.as_ref().and_then(|s| s.indices.binary_search(&i).ok().map(|k| s.values.get(k)));
        match replaced.or_else(|| self.data.map(|data| data.get(i))) {
            Some(bytes) => Cow::Borrowed(bytes),
            None => Cow::Owned(vec![0; self.size()]),
        }
    }

    /// Fails if the elements are not vectors of `N` numbers (or scalars).
    pub(super) fn expect_vectors(&self, n: usize) -> Result<(), ReadError> {
        if (self.columns, self.rows) == (1, n) {
            return Ok(());
        }
        let name = self.item.text("type").unwrap_or_default();
        Err(self.item.fault_at("type", format!("`{name}` where vectors of {n} numbers are needed")))
    }

    /// The first `N` numbers of an element that has as many.
    pub(super) fn numbers<const N: usize>(&self, i: usize) -> [f64; N] {
        let bytes = self.element(i);
        std::array::from_fn(|k| self.component.read(&bytes[k * self.component.size()..], self.normalized))
    }

    /// An element as an index.
    pub(super) fn index(&self, i: usize) -> usize {
        // 32 bits are exact in a double.
        self.component.read(&self.element(i), false) as usize
    }
}
