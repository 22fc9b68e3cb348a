//! Kinds of things, recognized by type: an instance of a subclass of a class of the package is one of its kind.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;
use std::collections::HashMap;

/// A class of the package.
pub struct Class {
    /// Its module, within the package.
    module: &'static str,
    name: &'static str,
    class: PyOnceLock<Py<PyType>>,
}

impl Class {
    /// The class `name` of the module `raywright.{module}`, imported on first use.
    pub const fn new(module: &'static str, name: &'static str) -> Self {
        Self { module, name, class: PyOnceLock::new() }
    }

    /// Whether an object is an instance of the class or of a subclass.
    ///
    /// # Errors
    /// If the class cannot be imported.
    pub fn has(&self, object: &Bound<'_, PyAny>) -> PyResult<bool> {
        object.is_instance(self.class.import(object.py(), &format!("raywright.{}", self.module), self.name)?)
    }
}

/// A function that reads an object by its attributes.
pub type Read<T> = fn(&Bound<'_, PyAny>) -> PyResult<T>;

/// The classes of one kind, such as materials, each with the function that reads its instances.
pub struct Kinds<R: 'static> {
    /// The beginning of the error for other objects, such as "material must be a raywright material".
    expected: &'static str,
    /// Module within the package, name and reader of each class.
    classes: &'static [(&'static str, &'static str, R)],
    /// Rows of `classes` by the addresses of the classes, which are kept so that no other object gets one.
    rows: PyOnceLock<HashMap<usize, (Py<PyType>, usize)>>,
}

impl<R> Kinds<R> {
    /// A table of classes, which are imported on first use.
    pub const fn new(expected: &'static str, classes: &'static [(&'static str, &'static str, R)]) -> Self {
        Self { expected, classes, rows: PyOnceLock::new() }
    }

    /// The reader of an object's class, or of the nearest base class in the table.
    ///
    /// # Errors
    /// A `TypeError` for an object of another type.
    pub fn reader(&self, object: &Bound<'_, PyAny>) -> PyResult<&'static R> {
        let class = object.get_type();
        match self.find(&class)? {
            Some(reader) => Ok(reader),
            None => Err(PyTypeError::new_err(format!("{}, got {}", self.expected, class.name()?))),
        }
    }

    /// The reader of a class, or of the nearest base class in the table.
    fn find(&self, class: &Bound<'_, PyType>) -> PyResult<Option<&'static R>> {
        let rows = self.rows.get_or_try_init(class.py(), || self.import(class.py()))?;
        let row = |class: &Bound<'_, PyAny>| rows.get(&(class.as_ptr() as usize)).map(|&(_, row)| &self.classes[row].2);
        Ok(row(class).or_else(|| class.mro().iter().find_map(|base| row(&base))))
    }

    fn import(&self, py: Python<'_>) -> PyResult<HashMap<usize, (Py<PyType>, usize)>> {
        let row = |(row, (module, name, _)): (usize, &(&str, &str, R))| {
            let class = py.import(format!("raywright.{module}"))?.getattr(*name)?.cast_into::<PyType>()?;
            Ok((class.as_ptr() as usize, (class.unbind(), row)))
        };
        self.classes.iter().enumerate().map(row).collect()
    }
}
