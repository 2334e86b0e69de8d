//! Vectors that Python sees through the buffer protocol, without copying.
#![allow(unsafe_code)] // Only here: a buffer is a pointer.

use std::ffi::c_int;
use std::sync::Arc;

use pyo3::ffi;
use pyo3::prelude::*;

/// Numbers that never change. NumPy views them with `numpy.frombuffer`.
#[pyclass(frozen)]
pub struct Values(pub Arc<Vec<f64>>);

#[pymethods]
impl Values {
    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// The address of the first number: equal for columns that share their memory.
    fn address(&self) -> usize {
        self.0.as_ptr() as usize
    }

    /// The vector stays where it is while a view exists: the view holds this object, and nothing changes it.
    unsafe fn __getbuffer__(
        slf: Bound<'_, Self>,
        view: *mut ffi::Py_buffer,
        flags: c_int,
    ) -> PyResult<()> {
        let values = &slf.get().0;
        let (start, bytes) = (values.as_ptr() as *mut _, size_of_val(values.as_slice()));
        // Refuses views that can write.
        let status = unsafe {
            ffi::PyBuffer_FillInfo(view, slf.as_ptr(), start, bytes as ffi::Py_ssize_t, 1, flags)
        };
        if status == 0 { Ok(()) } else { Err(PyErr::fetch(slf.py())) }
    }
}
