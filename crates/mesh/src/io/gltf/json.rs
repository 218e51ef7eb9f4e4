//! Walking through a document whose parts may be anything: every fault knows its place.

use serde_json::{Map, Value};

use super::super::error::ReadError;

/// A JSON object.
pub(super) type Object = Map<String, Value>;

/// Numbers up to here are whole when they look so: 2⁵³.
const LARGEST_WHOLE: f64 = 9_007_199_254_740_992.0;

/// An object of a document, and where it is.
#[derive(Clone)]
pub(super) struct Item<'a> {
    file: &'a str,
    /// Such as `meshes[0].primitives[1]`; empty for the whole document.
    path: String,
    fields: &'a Object,
}

impl<'a> Item<'a> {
    /// The whole document.
    pub(super) fn root(file: &'a str, fields: &'a Object) -> Self {
        Self { file, path: String::new(), fields }
    }

    /// All fields.
    pub(super) fn fields(&self) -> &'a Object {
        self.fields
    }

    /// Where a field is.
    fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// Something is wrong with this object.
    pub(super) fn fault(&self, reason: impl Into<String>) -> ReadError {
        let path = if self.path.is_empty() { "the document".to_owned() } else { self.path.clone() };
        ReadError::Document { file: self.file.to_owned(), path, reason: reason.into() }
    }

    /// Something is wrong with a field.
    pub(super) fn fault_at(&self, key: &str, reason: impl Into<String>) -> ReadError {
        ReadError::Document { file: self.file.to_owned(), path: self.path_of(key), reason: reason.into() }
    }

    /// This object is compressed geometry.
    pub(super) fn compressed(&self, extension: &'static str) -> ReadError {
        ReadError::Compressed { file: self.file.to_owned(), path: self.path_of("extensions"), extension }
    }

    /// The buffer that this object names is not there.
    pub(super) fn missing_buffer(&self, uri: &str, cause: std::io::Error) -> ReadError {
        ReadError::Buffer { file: self.file.to_owned(), path: self.path.clone(), uri: uri.to_owned(), cause }
    }

    /// A whole number that is not negative, if there is one.
    pub(super) fn number(&self, key: &str) -> Result<Option<usize>, ReadError> {
        let Some(value) = self.fields.get(key) else { return Ok(None) };
        let number = whole(value).and_then(|n| usize::try_from(n).ok());
        number.map(Some).ok_or_else(|| self.fault_at(key, format!("`{}` is not a whole number from 0", brief(value))))
    }

    /// A whole number that has to be there.
    pub(super) fn required(&self, key: &str) -> Result<usize, ReadError> {
        self.number(key)?.ok_or_else(|| self.fault(format!("`{key}` is missing")))
    }

    /// A text, if there is one.
    pub(super) fn text(&self, key: &str) -> Option<&'a str> {
        self.fields.get(key)?.as_str()
    }

    /// A field that is an object, if it is there.
    pub(super) fn object(&self, key: &str) -> Result<Option<Self>, ReadError> {
        self.fields.get(key).map(|value| self.item(value, self.path_of(key))).transpose()
    }

    /// The objects of a list; none if there is no list.
    pub(super) fn list(&self, key: &str) -> Result<Vec<Self>, ReadError> {
        let list = self.fields.get(key).map(|value| {
            let list = value.as_array().ok_or_else(|| self.fault_at(key, "is not a list"))?;
            list.iter().enumerate().map(|(i, value)| self.item(value, format!("{}[{i}]", self.path_of(key)))).collect()
        });
        list.unwrap_or_else(|| Ok(Vec::new()))
    }

    /// One object of a list, named by the field `from` of another object.
    pub(super) fn element(&self, key: &str, index: usize, from: (&Self, &str)) -> Result<Self, ReadError> {
        let list = self.fields.get(key).and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let missing = || {
            let reason = format!("names {key}[{index}], but there are only {} (counted from 0)", list.len());
            from.0.fault_at(from.1, reason)
        };
        self.item(list.get(index).ok_or_else(missing)?, format!("{}[{index}]", self.path_of(key)))
    }

    fn item(&self, value: &'a Value, path: String) -> Result<Self, ReadError> {
        match value {
            Value::Object(fields) => Ok(Self { file: self.file, path, fields }),
            _ => Err(ReadError::Document { file: self.file.to_owned(), path, reason: "is not an object".to_owned() }),
        }
    }
}

/// A whole number from 0, however it is written.
pub(super) fn whole(value: &Value) -> Option<u64> {
    let number = value.as_u64();
    number.or_else(|| {
        let number = value.as_f64()?;
        ((0.0..LARGEST_WHOLE).contains(&number) && number.fract() == 0.0).then_some(number as u64)
    })
}

/// A value as a message repeats it.
fn brief(value: &Value) -> String {
    match value {
        Value::Array(_) => "[…]".to_owned(),
        Value::Object(_) => "{…}".to_owned(),
        other => super::super::text::quote(other.to_string().as_bytes()),
    }
}
