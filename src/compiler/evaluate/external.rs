//! External functions and objects (sections 12.9 and 12.9.7 of the specification). C is not
//! compiled: what libraries need for tables and texts is computed here, from its documentation.
//!
//! An external object is known before the model runs. It is held as a text that numbers it, so that
//! it passes through parameters, modifications and arguments like any other value.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::Evaluator;
use super::cause::call::CallCause;
use super::moved_table::Moved;
use super::value::Value;
use crate::base::diag::Diagnostic;
use crate::base::name::{Name, name};
use crate::base::source::Span;
use crate::external::component::{Asked, Component, ComponentCall};
use crate::external::files::{self, Files};
use crate::external::table::Extrapolation;
use crate::external::table::curve::Curve;
use crate::external::table::operator::{CurveValue, NextTimeEvent, SurfaceValue, TimeTableValue};
use crate::external::table::surface::Surface;
use crate::external::table::time_table::{Placing, Stops, TimeTable};
use crate::external::{Data, Fault, Function};
use crate::io::matrix_file::Matrix;
use crate::ir::ast::{ClassKind, ComponentRef, Expr, ExprKind, External};
use crate::ir::expr::{Binary, Const, EnumId, ExprId, Graph, Type, Unary};
use crate::ir::external::ExternalId;
use crate::ir::flat::AssertionLevel;
use crate::ir::instance::{ClassId, Scope};
use crate::numeric::hermite::Smoothness;
use crate::resolve::library::Library;

/// What stands before the number of an object.
const MARK: &str = "external object ";

/// An external object.
#[derive(Clone, Debug)]
pub(crate) enum Object {
    /// Columns over the first one.
    Curves(Vec<Arc<Curve>>),
    /// Columns over time, and what moves them if it is not known before simulation.
    TimeTables(Vec<Arc<TimeTable>>, Option<Moved>),
    /// A grid.
    Surface(Arc<Surface>),
    /// A foreign model.
    Component(Arc<dyn Component>),
}

/// Why an external function has no result.
pub(super) enum Refusal {
    /// It is not one of those known here.
    Unknown,
    /// What is wrong was reported.
    Reported,
    /// What is wrong with its arguments.
    Wrong(String),
}

impl Evaluator<'_> {
    /// True for a class that extends `ExternalObject`.
    pub(crate) fn is_external_object(&mut self, class: ClassId) -> bool {
        self.kind(class) == ClassKind::Class && self.table(class).scalar == Some(Type::String)
    }

    /// Calls an external function whose inputs are locals, and assigns its outputs.
    pub(super) fn run_external(
        &mut self,
        class: ClassId,
        external: &External,
        inputs: &[Name],
        outputs: &[Name],
        scope: Scope,
        span: Span,
    ) -> Option<()> {
        let called = match external.function {
            Some(f) => f.name,
            None => {
                let full_name = self.classes[class].full_name;
                name(full_name.rsplit('.').next().unwrap_or_default())
            }
        };
        if let Some(solved) = self.lapack(&called, external, scope) {
            match solved {
                Ok(results) => {
                    for (to, value) in results {
                        self.assign_local(to, value)?;
                    }
                    return Some(());
                }
                Err(why) => {
                    self.report_refusal(&called, why, external, span);
                    return None;
                }
            }
        }
        let is_output = |e: &Expr| match &e.kind {
            ExprKind::Ref(r) => r.simple().filter(|n| outputs.contains(n)),
            _ => None,
        };
        // Without a mapping of its own a function gets its inputs and gives its output.
        let mut args = Vec::new();
        let mut results = Vec::new();
        match (&external.function, &external.output) {
            (None, _) => {
                for input in inputs {
                    args.push(self.local_value(*input)?);
                }
                results.extend(outputs.iter().copied());
            }
            (Some(_), output) => {
                results.extend(output.as_ref().and_then(ComponentRef::simple));
                for e in &external.args {
                    match is_output(e) {
                        Some(output) => results.push(output),
                        None => args.push(self.evaluate(e, scope)?),
                    }
                }
            }
        }
        let values = match self.native(&called, &args, span) {
            Ok(values) => values,
            Err(why) => {
                self.report_refusal(&called, why, external, span);
                return None;
            }
        };
        for (to, value) in results.into_iter().zip(values) {
            self.assign_local(to, value)?;
        }
        Some(())
    }

    fn assign_local(&mut self, to: Name, value: Value) -> Option<()> {
        let locals = self.frames.visible_mut();
        locals.iter_mut().find(|(n, _)| *n == to)?.1 = value;
        Some(())
    }

    fn report_refusal(&mut self, called: &str, why: Refusal, external: &External, span: Span) {
        let function = called.to_string();
        let cause = match why {
            Refusal::Reported => return,
            Refusal::Wrong(why) => CallCause::ExternalFailed { function, why },
            Refusal::Unknown => CallCause::UnknownExternal { function },
        };
        self.problems
            .push(Diagnostic::new(cause, span).also(external.span, "declared external here"));
    }

    fn local_value(&self, wanted: Name) -> Option<Value> {
        let locals = self.frames.visible();
        locals.iter().find(|(n, _)| *n == wanted).map(|(_, v)| v.clone())
    }

    fn native(&mut self, called: &str, args: &[Value], span: Span) -> Result<Vec<Value>, Refusal> {
        if let Some(result) = self.function_of_mathematics(called, args) {
            return Ok(vec![Value::Scalar(result)]);
        }
        if let Some(generator) = called.strip_prefix("ModelicaRandom_") {
            return self.random_function(generator, args, span);
        }
        if called == "ModelicaFFT_kiss_fftr" {
            return self.fourier_function(args, span);
        }
        if let Some(what) = called.strip_prefix("mocc_fmu_") {
            return self.component_function(what, args);
        }
        let Some(table) = called.strip_prefix("ModelicaStandardTables_") else {
            return self.known_function(called, args, span);
        };
        let (kind, what) = table.split_once('_').ok_or(Refusal::Unknown)?;
        // The older form has no arguments about text files at its end.
        if matches!(what, "init2" | "init3") {
            let object = match kind {
                "CombiTimeTable" => self.time_tables(args)?,
                "CombiTable1D" => self.curves(args)?,
                "CombiTable2D" => self.surface(args)?,
                _ => return Err(Refusal::Unknown),
            };
            return Ok(vec![self.new_object(object)]);
        }
        let object = self.object_of(args.first())?;
        let scalars: Option<Vec<ExprId>> = args[1..].iter().map(Value::scalar).collect();
        self.table_function(what, &object, &scalars.ok_or(Refusal::Unknown)?, span)
    }

    /// Keeps an object; the text that numbers it.
    fn new_object(&mut self, object: Object) -> Value {
        self.objects.push(object);
        let text = format!("{MARK}{}", self.objects.len());
        Value::Scalar(self.graph.string(&text))
    }

    /// A function of a foreign model: `open(file, token)`, `set(fmu, name, state, value)`, `begin(fmu, state, start)`,
    /// `step(fmu, state, size)`, `get(fmu, name, state)`.
    fn component_function(&mut self, what: &str, args: &[Value]) -> Result<Vec<Value>, Refusal> {
        if let ("open", [file, token]) = (what, args) {
            let (file, token) = (self.text_of(file)?, self.text_of(token)?);
            let found = self.library.component(Path::new(&file), &token);
            let component = found.map_err(|why| Refusal::Wrong(format!("`{file}`: {why}")))?;
            return Ok(vec![self.new_object(Object::Component(component))]);
        }
        let Object::Component(component) = self.object_of(args.first())? else {
            return Err(Refusal::Wrong("this is not an FMU".into()));
        };
        let (asked, rest) = match (what, &args[1..]) {
            ("set", [name, rest @ ..]) => {
                (Asked::Set(self.value_of_component(&*component, name)?), rest)
            }
            ("get", [name, rest @ ..]) => {
                (Asked::Get(self.value_of_component(&*component, name)?), rest)
            }
            ("begin", rest) => (Asked::Begin, rest),
            ("step", rest) => (Asked::Step, rest),
            _ => return Err(Refusal::Unknown),
        };
        let scalars: Option<Vec<ExprId>> = rest.iter().map(Value::scalar).collect();
        let f = self.graph.add_external(Arc::new(ComponentCall { component, asked }));
        let called = match scalars.as_deref() {
            Some([a]) if matches!(asked, Asked::Get(_)) => self.graph.unary(Unary::External(f), *a),
            Some([a, b]) if !matches!(asked, Asked::Get(_)) => {
                self.graph.binary(Binary::External(f), *a, *b)
            }
            _ => return Err(Refusal::Unknown),
        };
        Ok(vec![Value::Scalar(called)])
    }

    /// The number of a value of a foreign model by the name of its variable.
    fn value_of_component(
        &mut self,
        component: &dyn Component,
        name: &Value,
    ) -> Result<usize, Refusal> {
        let name = self.text_of(name)?;
        let found = component.value(&name);
        found.ok_or_else(|| Refusal::Wrong(format!("the FMU has no variable `{name}`")))
    }

    /// A function of the C library, or one that is built in by that name.
    fn function_of_mathematics(&mut self, called: &str, args: &[Value]) -> Option<ExprId> {
        let scalars: Vec<ExprId> = args.iter().map(Value::scalar).collect::<Option<_>>()?;
        match *scalars.as_slice() {
            [a] => {
                let c_name = called == "fabs";
                let op = if c_name { Unary::Abs } else { Unary::called(called)? };
                Some(self.graph.unary(op, a))
            }
            [a, b] if called == "pow" => Some(self.graph.pow(a, b)),
            [a, b] => match Binary::called(called)? {
                op @ Binary::Atan2 => Some(self.graph.binary(op, a, b)),
                _ => None,
            },
            _ => None,
        }
    }

    /// A function without a derivative: its arguments must be known, but for the lines to print.
    fn known_function(
        &mut self,
        called: &str,
        args: &[Value],
        span: Span,
    ) -> Result<Vec<Value>, Refusal> {
        match (called, args) {
            // Printed while the model is simulated, not while it is compiled.
            ("ModelicaInternal_print", [line, file]) => {
                let file = self.text_of(file)?;
                let line = line.scalar().ok_or(Refusal::Unknown)?;
                let never = self.graph.boolean(false);
                let level = AssertionLevel::Print(name(&file));
                self.assert_now_or_later(never, line, level, span).ok_or(Refusal::Reported)?;
                return Ok(Vec::new());
            }
            ("ModelicaError" | "ModelicaWarning" | "ModelicaMessage", [text]) => {
                let level = match called {
                    "ModelicaError" => AssertionLevel::Error,
                    _ => AssertionLevel::Warning,
                };
                let text = text.scalar().ok_or(Refusal::Unknown)?;
                let never = self.graph.boolean(false);
                self.assert_now_or_later(never, text, level, span).ok_or(Refusal::Reported)?;
                return Ok(Vec::new());
            }
            ("ModelicaStreams_closeFile", _) => return Ok(Vec::new()),
            ("ModelicaIO_writeRealMatrix", _) => {
                self.report(CallCause::FileNotWritten, span);
                return Ok(vec![Value::Scalar(self.graph.boolean(false))]);
            }
            _ => {}
        }
        let function = Function::named(called).ok_or(Refusal::Unknown)?;
        let args: Result<Vec<Data>, Refusal> = args.iter().map(|a| self.data_of(a)).collect();
        match function.call(&args?, self.library) {
            Err(Fault::Signature) => Err(Refusal::Unknown),
            Err(Fault::Message(why)) => Err(Refusal::Wrong(why)),
            Ok(results) => Ok(results.into_iter().map(|data| self.value_of(data)).collect()),
        }
    }

    /// A value whose scalars are all known.
    fn data_of(&mut self, value: &Value) -> Result<Data, Refusal> {
        let data = |c: Const| match c {
            c @ Const::Real(_) => Data::Real(c.register()),
            Const::Integer(i) => Data::Integer(i),
            Const::Boolean(b) => Data::Boolean(b),
            Const::String(s) => Data::String(s.to_string()),
            Const::Enumeration(_, k) => Data::Integer(i64::from(k)),
        };
        let mut scalars: Vec<Data> = self.known(value)?.into_iter().map(data).collect();
        match value.dims() {
            [] => scalars.pop().ok_or(Refusal::Unknown),
            dims => Ok(Data::Array(dims.to_vec(), scalars)),
        }
    }

    fn value_of(&mut self, data: Data) -> Value {
        Value::Scalar(match data {
            Data::Real(x) => self.graph.real(x),
            Data::Integer(i) => self.graph.integer(i),
            Data::Boolean(b) => self.graph.boolean(b),
            Data::String(s) => self.graph.string(&s),
            Data::Literal(literals, k) => {
                let enumeration = self.enumeration_of(literals);
                let literal = enumeration.map(|e| Const::Enumeration(e, k));
                self.graph.constant(literal.unwrap_or(Const::Integer(i64::from(k))))
            }
            Data::Array(dims, elements) => {
                let elements = elements.into_iter().map(|e| self.value_of(e)).collect();
                return Value::array(dims, elements);
            }
        })
    }

    /// The enumeration with these literals.
    fn enumeration_of(&self, wanted: &[&str]) -> Option<EnumId> {
        let matches = |id: &EnumId| {
            let literals = &self.graph.enumerations[*id].literals;
            literals.iter().map(|l| l.as_str()).eq(wanted.iter().copied())
        };
        self.graph.enumerations.ids().find(matches)
    }

    fn object_of(&mut self, handle: Option<&Value>) -> Result<Object, Refusal> {
        let e = handle.and_then(Value::scalar).ok_or(Refusal::Unknown)?;
        let text = match self.structural_value(e) {
            Some(Const::String(text)) => text,
            // The reason has been reported.
            _ if self.problems.has_errors() => return Err(Refusal::Reported),
            _ => return Err(Refusal::Wrong("the external object has no value".into())),
        };
        let number = text.strip_prefix(MARK).and_then(|n| n.parse::<usize>().ok());
        let object = number.and_then(|n| self.objects.get(n.checked_sub(1)?));
        object.cloned().ok_or_else(|| Refusal::Wrong("this is not an external object".into()))
    }

    fn table_function(
        &mut self,
        what: &str,
        object: &Object,
        args: &[ExprId],
        span: Span,
    ) -> Result<Vec<Value>, Refusal> {
        let one = |e| Ok(vec![Value::Scalar(e)]);
        match (object, what, args) {
            (Object::TimeTables(all, _), "minimumTime", []) => {
                one(self.graph.real(all.first().map_or(0.0, |c| c.range().0)))
            }
            (Object::TimeTables(all, _), "maximumTime", []) => {
                one(self.graph.real(all.first().map_or(0.0, |c| c.range().1)))
            }
            (Object::TimeTables(all, moved), "nextTimeEvent", [t]) => {
                let table = all.first().ok_or(Refusal::Unknown)?.clone();
                let f = self.graph.add_external(Arc::new(NextTimeEvent(table)));
                one(match moved {
                    None => self.graph.unary(Unary::External(f), *t),
                    Some(moved) => moved.next_event(&mut self.graph, f, *t),
                })
            }
            (Object::TimeTables(all, moved), _, [column, t, next, _, rates @ ..]) => {
                let table = self.column(all, *column)?;
                let f = self.graph.add_external(Arc::new(TimeTableValue { table, order: 0 }));
                let at = |graph: &mut Graph, f| match moved {
                    None => graph.binary(Binary::External(f), *t, *next),
                    Some(moved) => moved.value(graph, f, *t, *next),
                };
                let value = at(&mut self.graph, f);
                let slopes = self.slopes(f, at);
                self.rate(what, value, &slopes, rates)
            }
            (Object::Curves(all), "minimumAbscissa", []) => {
                one(self.graph.real(all.first().map_or(0.0, |c| c.range().0)))
            }
            (Object::Curves(all), "maximumAbscissa", []) => {
                one(self.graph.real(all.first().map_or(0.0, |c| c.range().1)))
            }
            (Object::Curves(all), _, [column, u, rates @ ..]) => {
                let curve = self.column(all, *column)?;
                if curve.extrapolation() == Extrapolation::Forbidden {
                    self.inside(*u, curve.range(), span)?;
                }
                let f = self.graph.add_external(Arc::new(CurveValue { curve, order: 0 }));
                let value = self.graph.unary(Unary::External(f), *u);
                let slopes = self.slopes(f, |graph, f| graph.unary(Unary::External(f), *u));
                self.rate(what, value, &slopes, rates)
            }
            (Object::Surface(surface), "minimumAbscissa" | "maximumAbscissa", []) => {
                let least = what == "minimumAbscissa";
                let ends = surface.range().map(|(a, b)| if least { a } else { b });
                Ok(vec![Value::vector(ends.iter().map(|x| self.graph.real(*x)).collect())])
            }
            (Object::Surface(surface), "getValue" | "getDerValue", [u, v, rates @ ..]) => {
                if surface.extrapolation() == Extrapolation::Forbidden {
                    let [x, y] = surface.range();
                    self.inside(*u, x, span)?;
                    self.inside(*v, y, span)?;
                }
                let value = SurfaceValue { surface: surface.clone(), orders: (0, 0) };
                let f = self.graph.add_external(Arc::new(value));
                if what == "getValue" {
                    return one(self.graph.binary(Binary::External(f), *u, *v));
                }
                let mut terms = Vec::new();
                for (k, rate) in rates.iter().take(2).enumerate() {
                    if let Some(d) = self.graph.external_derivative(f, k) {
                        let slope = self.graph.binary(Binary::External(d), *u, *v);
                        terms.push(self.graph.mul(slope, *rate));
                    }
                }
                one(self.graph.sum(terms))
            }
            _ => Err(Refusal::Unknown),
        }
    }

    /// The first and second derivative of a function by its first argument.
    fn slopes(
        &mut self,
        f: ExternalId,
        apply: impl Fn(&mut Graph, ExternalId) -> ExprId,
    ) -> [ExprId; 2] {
        let first = self.graph.external_derivative(f, 0);
        let second = first.and_then(|f| self.graph.external_derivative(f, 0));
        [first, second].map(|f| match f {
            Some(f) => apply(&mut self.graph, f),
            None => self.graph.real(0.0),
        })
    }

    /// The value of a function of one argument, or its first or second derivative by time.
    fn rate(
        &mut self,
        what: &str,
        value: ExprId,
        slopes: &[ExprId],
        rates: &[ExprId],
    ) -> Result<Vec<Value>, Refusal> {
        let result = match (what, rates) {
            ("getValue", []) => value,
            ("getDerValue", [first]) => self.graph.mul(slopes[0], *first),
            ("getDer2Value", [first, second]) => {
                let square = self.graph.mul(*first, *first);
                let curved = self.graph.mul(slopes[1], square);
                let straight = self.graph.mul(slopes[0], *second);
                self.graph.add(curved, straight)
            }
            _ => return Err(Refusal::Unknown),
        };
        Ok(vec![Value::Scalar(result)])
    }

    fn column<T: Clone>(&mut self, all: &[T], column: ExprId) -> Result<T, Refusal> {
        match self.structural_value(column) {
            Some(Const::Integer(k)) if k >= 1 && k as usize <= all.len() => {
                Ok(all[k as usize - 1].clone())
            }
            Some(Const::Integer(k)) => {
                Err(Refusal::Wrong(format!("column {k} is outside 1 to {}", all.len())))
            }
            _ => Err(Refusal::Wrong("the column must be known before simulation".into())),
        }
    }

    /// Asserts that an argument stays inside a table that does not go on beyond.
    fn inside(&mut self, u: ExprId, range: (f64, f64), span: Span) -> Result<(), Refusal> {
        let (first, last) = (self.graph.real(range.0), self.graph.real(range.1));
        let above = self.graph.binary(Binary::GreaterEqual, u, first);
        let below = self.graph.binary(Binary::LessEqual, u, last);
        let condition = self.graph.and(above, below);
        let text = format!(
            "the argument of a table without extrapolation left its range from {} to {}",
            range.0, range.1
        );
        let message = self.graph.string(&text);
        self.assert_now_or_later(condition, message, AssertionLevel::Error, span)
            .ok_or(Refusal::Reported)
    }

    /// `fileName, tableName, table, rows, columns, columns to use, their number, smoothness,
    /// extrapolation, ...`
    fn curves(&mut self, args: &[Value]) -> Result<Object, Refusal> {
        let [file, name, table, _, _, columns, _, smoothness, extrapolation, ..] = args else {
            return Err(Refusal::Unknown);
        };
        let table = self.table_data(file, name, table)?;
        let x = table.column(1).map_err(Refusal::Wrong)?;
        let (smoothness, extrapolation) = self.interpretation(smoothness, extrapolation)?;
        let mut all = Vec::new();
        for k in self.numbers(columns)? {
            let y = table.column(k as usize).map_err(Refusal::Wrong)?;
            let curve = Curve::new(&x, &y, smoothness, extrapolation);
            all.push(Arc::new(curve.ok_or_else(|| {
                Refusal::Wrong("the first column of the table must rise from row to row".into())
            })?));
        }
        Ok(Object::Curves(all))
    }

    /// `fileName, tableName, table, rows, columns, start, columns to use, their number, smoothness,
    /// extrapolation, shift, events, ...`
    fn time_tables(&mut self, args: &[Value]) -> Result<Object, Refusal> {
        let [
            file,
            name,
            table,
            _,
            _,
            start,
            columns,
            _,
            smoothness,
            extrapolation,
            shift,
            stops,
            ..,
        ] = args
        else {
            return Err(Refusal::Unknown);
        };
        let table = self.table_data(file, name, table)?;
        let t = table.column(1).map_err(Refusal::Wrong)?;
        let (smoothness, extrapolation) = self.interpretation(smoothness, extrapolation)?;
        let (moved, at_start, by_shift) = self.placed(start, shift)?;
        let placing = Placing {
            start: at_start,
            shift: by_shift,
            stops: match self.number_of(stops)? as u32 {
                1 => Stops::Always,
                2 => Stops::AtJumps,
                _ => Stops::Never,
            },
        };
        let mut all = Vec::new();
        for k in self.numbers(columns)? {
            let y = table.column(k as usize).map_err(Refusal::Wrong)?;
            let table = TimeTable::new(&t, &y, smoothness, extrapolation, placing);
            all.push(Arc::new(table.ok_or_else(|| {
                Refusal::Wrong("the first column of the table must not fall from row to row".into())
            })?));
        }
        Ok(Object::TimeTables(all, moved))
    }

    /// The start and the shift of a table over time, as numbers if they are known. Initialization may
    /// determine them: then the table stays, and what reads it moves.
    fn placed(
        &mut self,
        start: &Value,
        shift: &Value,
    ) -> Result<(Option<Moved>, f64, f64), Refusal> {
        let (numbers, reported) =
            self.collect_problems(|cx| (cx.number_of(start), cx.number_of(shift)));
        if let (Ok(start), Ok(shift)) = numbers {
            reported.iter().for_each(|d| self.problems.push(d.clone()));
            return Ok((None, start, shift));
        }
        let start = start.scalar().ok_or(Refusal::Unknown)?;
        let shift = shift.scalar().ok_or(Refusal::Unknown)?;
        Ok((Some(Moved { start, shift }), f64::MIN, 0.0))
    }

    /// `fileName, tableName, table, rows, columns, smoothness, extrapolation, ...`
    fn surface(&mut self, args: &[Value]) -> Result<Object, Refusal> {
        let [file, name, table, _, _, smoothness, extrapolation, ..] = args else {
            return Err(Refusal::Unknown);
        };
        let table = self.table_data(file, name, table)?;
        let (smoothness, extrapolation) = self.interpretation(smoothness, extrapolation)?;
        if table.rows < 2 || table.columns < 2 {
            return Err(Refusal::Wrong("the table has no grid".into()));
        }
        let x = table.column(1).map_err(Refusal::Wrong)?[1..].to_vec();
        let y = table.elements[1..table.columns].to_vec();
        let rows = table.elements.chunks_exact(table.columns).skip(1);
        let z: Vec<f64> = rows.flat_map(|row| row[1..].iter().copied()).collect();
        let surface = Surface::new(&x, &y, &z, smoothness, extrapolation);
        surface.map(|s| Object::Surface(Arc::new(s))).ok_or_else(|| {
            Refusal::Wrong("the first row and column must rise, and a grid is linear, constant or with continuous derivatives".into())
        })
    }

    fn interpretation(
        &mut self,
        smoothness: &Value,
        extrapolation: &Value,
    ) -> Result<(Smoothness, Extrapolation), Refusal> {
        let (s, e) = (self.number_of(smoothness)?, self.number_of(extrapolation)?);
        let both = (Smoothness::numbered(s as u32), Extrapolation::numbered(e as u32));
        match both {
            (Some(s), Some(e)) => Ok((s, e)),
            _ => Err(Refusal::Wrong("there is no such smoothness or extrapolation".into())),
        }
    }

    fn number_of(&mut self, value: &Value) -> Result<f64, Refusal> {
        self.numbers(value)?.first().copied().ok_or(Refusal::Unknown)
    }

    fn numbers(&mut self, value: &Value) -> Result<Vec<f64>, Refusal> {
        Ok(self.known(value)?.into_iter().map(Const::register).collect())
    }

    /// The values of all scalars of a value, which must be known before the model runs.
    pub(super) fn known(&mut self, value: &Value) -> Result<Vec<Const>, Refusal> {
        let mut scalars = Vec::new();
        value.for_each_scalar(&mut |e| scalars.push(e));
        let mut known = Vec::with_capacity(scalars.len());
        for e in scalars {
            known.push(self.parameter_expression(e, true).ok_or_else(|| {
                Refusal::Wrong("its arguments must be known before simulation".into())
            })?);
        }
        Ok(known)
    }

    /// The table that is given, or that of this name in a file.
    fn table_data(&mut self, file: &Value, name: &Value, table: &Value) -> Result<Matrix, Refusal> {
        let file = self.text_of(file)?;
        let matrix = if file == "NoName" || file.trim().is_empty() {
            let [rows, columns] = *table.dims() else {
                return Err(Refusal::Wrong("a table is a matrix".into()));
            };
            Matrix { rows, columns, elements: self.numbers(table)? }
        } else {
            let name = self.text_of(name)?;
            files::matrix(&file, &name, self.library).map_err(|fault| match fault {
                Fault::Signature => Refusal::Unknown,
                Fault::Message(why) => Refusal::Wrong(why),
            })?
        };
        if matrix.rows == 0 {
            return Err(Refusal::Wrong("the table is empty".into()));
        }
        Ok(matrix)
    }

    /// A text that is known before the model runs.
    pub(super) fn text_of(&mut self, value: &Value) -> Result<String, Refusal> {
        match self.known(value)?.first() {
            Some(Const::String(t)) => Ok(t.to_string()),
            _ => Err(Refusal::Unknown),
        }
    }
}

impl Files for Library {
    fn read(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        self.data(path)
    }

    fn component(&mut self, path: &Path, token: &str) -> Result<Arc<dyn Component>, String> {
        Library::component(self, path, token)
    }

    fn resource(&mut self, uri: &str) -> Option<PathBuf> {
        Library::resource(self, uri)
    }
}

/// The name of the function that makes an external object.
pub(super) fn constructor() -> Name {
    name("constructor")
}
