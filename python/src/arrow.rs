//! A run as a stream of the Arrow C data interface: one batch, whose columns are the vectors of the run.
//!
//! Apache Arrow: *The Arrow C data interface* and *The Arrow C stream interface*. All columns are `float64` without
//! missing values; the metadata of a column hold its `unit` and `description`.
#![allow(unsafe_code)] // Only here: the interface is made of pointers.

use std::ffi::{CString, c_char, c_int, c_void};
use std::ptr::{null, null_mut};
use std::sync::Arc;

use mocc::ir::trajectory::Column;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;

/// The type of a column or a table.
#[repr(C)]
struct Schema {
    format: *const c_char,
    name: *const c_char,
    metadata: *const c_char,
    flags: i64,
    n_children: i64,
    children: *mut *mut Schema,
    dictionary: *mut Schema,
    release: Option<unsafe extern "C" fn(*mut Schema)>,
    private_data: *mut c_void,
}

/// The values of a column or a table.
#[repr(C)]
struct Array {
    length: i64,
    null_count: i64,
    offset: i64,
    n_buffers: i64,
    n_children: i64,
    buffers: *mut *const c_void,
    children: *mut *mut Array,
    dictionary: *mut Array,
    release: Option<unsafe extern "C" fn(*mut Array)>,
    private_data: *mut c_void,
}

/// A stream of tables.
#[repr(C)]
struct Stream {
    get_schema: unsafe extern "C" fn(*mut Stream, *mut Schema) -> c_int,
    get_next: unsafe extern "C" fn(*mut Stream, *mut Array) -> c_int,
    get_last_error: unsafe extern "C" fn(*mut Stream) -> *const c_char,
    release: Option<unsafe extern "C" fn(*mut Stream)>,
    private_data: *mut c_void,
}

// The pointers of a stream lead to memory that it owns.
unsafe impl Send for Stream {}

/// The columns of a stream, the time first.
struct Table {
    columns: Vec<(Column, Arc<Vec<f64>>)>,
    /// The batch was taken.
    is_taken: bool,
}

/// A capsule with a stream of these columns, all of one length.
pub fn capsule(
    py: Python<'_>,
    columns: Vec<(Column, Arc<Vec<f64>>)>,
) -> PyResult<Bound<'_, PyCapsule>> {
    let table = Box::new(Table { columns, is_taken: false });
    let stream = Stream {
        get_schema,
        get_next,
        get_last_error,
        release: Some(release_stream),
        private_data: Box::into_raw(table).cast(),
    };
    PyCapsule::new_with_value_and_destructor(py, stream, c"arrow_array_stream", |mut stream, _| {
        // A consumer that has taken the stream has taken this away.
        if let Some(release) = stream.release {
            unsafe { release(&mut stream) }
        }
    })
}

unsafe extern "C" fn get_schema(stream: *mut Stream, out: *mut Schema) -> c_int {
    let table = unsafe { &*(*stream).private_data.cast::<Table>() };
    let children = table.columns.iter().map(|(column, _)| {
        let metadata = metadata(&[("unit", &column.unit), ("description", &column.description)]);
        schema(c"g".into(), &column.name, metadata, Vec::new())
    });
    let whole = schema(c"+s".into(), "", Vec::new(), children.collect());
    unsafe { out.write(whole) };
    0
}

unsafe extern "C" fn get_next(stream: *mut Stream, out: *mut Array) -> c_int {
    let table = unsafe { &mut *(*stream).private_data.cast::<Table>() };
    if std::mem::replace(&mut table.is_taken, true) {
        // The end of the stream is an array that is released.
        let mut end = array(0, Vec::new(), None, Vec::new());
        if let Some(release) = end.release {
            unsafe { release(&mut end) };
        }
        unsafe { out.write(end) };
        return 0;
    }
    let rows = table.columns.first().map_or(0, |(_, values)| values.len());
    let children = table.columns.iter().map(|(_, values)| {
        let buffers = vec![null(), values.as_ptr().cast()];
        array(rows, buffers, Some(Arc::clone(values)), Vec::new())
    });
    let whole = array(rows, vec![null()], None, children.collect());
    unsafe { out.write(whole) };
    0
}

/// Nothing here can fail.
unsafe extern "C" fn get_last_error(_: *mut Stream) -> *const c_char {
    null()
}

unsafe extern "C" fn release_stream(stream: *mut Stream) {
    let stream = unsafe { &mut *stream };
    drop(unsafe { Box::from_raw(stream.private_data.cast::<Table>()) });
    stream.private_data = null_mut();
    stream.release = None;
}

/// Memory of a schema.
struct SchemaMemory {
    _format: CString,
    _name: CString,
    _metadata: Vec<u8>,
    children: Vec<*mut Schema>,
}

fn schema(format: CString, name: &str, metadata: Vec<u8>, children: Vec<Schema>) -> Schema {
    // Names of variables hold no zeros.
    let name = CString::new(name).unwrap_or_default();
    let children = children.into_iter().map(|child| Box::into_raw(Box::new(child))).collect();
    let mut memory =
        Box::new(SchemaMemory { _format: format, _name: name, _metadata: metadata, children });
    Schema {
        format: memory._format.as_ptr(),
        name: memory._name.as_ptr(),
        metadata: if memory._metadata.is_empty() {
            null()
        } else {
            memory._metadata.as_ptr().cast()
        },
        flags: 0,
        n_children: memory.children.len() as i64,
        children: memory.children.as_mut_ptr(),
        dictionary: null_mut(),
        release: Some(release_schema),
        private_data: Box::into_raw(memory).cast(),
    }
}

unsafe extern "C" fn release_schema(schema: *mut Schema) {
    let schema = unsafe { &mut *schema };
    let memory = unsafe { Box::from_raw(schema.private_data.cast::<SchemaMemory>()) };
    for child in memory.children {
        let mut child = unsafe { Box::from_raw(child) };
        if let Some(release) = child.release {
            unsafe { release(&mut *child) };
        }
    }
    schema.release = None;
}

/// Memory of an array.
struct ArrayMemory {
    _values: Option<Arc<Vec<f64>>>,
    buffers: Vec<*const c_void>,
    children: Vec<*mut Array>,
}

fn array(
    rows: usize,
    buffers: Vec<*const c_void>,
    values: Option<Arc<Vec<f64>>>,
    children: Vec<Array>,
) -> Array {
    let children = children.into_iter().map(|child| Box::into_raw(Box::new(child))).collect();
    let mut memory = Box::new(ArrayMemory { _values: values, buffers, children });
    Array {
        length: rows as i64,
        null_count: 0,
        offset: 0,
        n_buffers: memory.buffers.len() as i64,
        n_children: memory.children.len() as i64,
        buffers: memory.buffers.as_mut_ptr(),
        children: memory.children.as_mut_ptr(),
        dictionary: null_mut(),
        release: Some(release_array),
        private_data: Box::into_raw(memory).cast(),
    }
}

unsafe extern "C" fn release_array(array: *mut Array) {
    let array = unsafe { &mut *array };
    let memory = unsafe { Box::from_raw(array.private_data.cast::<ArrayMemory>()) };
    for child in memory.children {
        let mut child = unsafe { Box::from_raw(child) };
        if let Some(release) = child.release {
            unsafe { release(&mut *child) };
        }
    }
    array.release = None;
}

/// Pairs of strings: their number, then each with its length.
fn metadata(pairs: &[(&str, &str)]) -> Vec<u8> {
    let pairs: Vec<_> = pairs.iter().filter(|(_, value)| !value.is_empty()).collect();
    if pairs.is_empty() {
        return Vec::new();
    }
    let mut out = (pairs.len() as i32).to_ne_bytes().to_vec();
    for text in pairs.into_iter().flat_map(|(key, value)| [key, value]) {
        out.extend((text.len() as i32).to_ne_bytes());
        out.extend(text.as_bytes());
    }
    out
}
