//! Short formulas that may stand for a free curve, and the classes that hold them.
//!
//! A formula is a sum of a few terms, each an amplitude times a function of `u = (x - x_m)/x_0`, the variable of
//! the curve in units of its range. The functions have at most two shape parameters.

use super::catalogue::{Amplitude, Effect, Start};

/// How a formula takes the place of a free curve, from the annotation of its class.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FreeCurve {
    /// The class of the same package that the law extends.
    pub extends: String,
    /// The amplitudes that are the values of the curve.
    pub knots: String,
    /// The parameter that is their number.
    pub count: Option<String>,
    /// The variable that it depends on.
    pub over: String,
    /// The parameter that is its first knot; without it, the curve begins at 0.
    pub from: Option<String>,
    /// The parameter that is its last knot.
    pub to: String,
    /// It passes through 0 at 0, and its first knot is at least one `n`-th of the last.
    pub is_zero_at_zero: bool,
    /// It is 0 at its first knot, which is no amplitude: a constant would be a part of the parameter that it multiplies.
    pub is_anchored: bool,
    /// The equations of the law, with `F(x)` for the formula.
    pub equations: Vec<String>,
}

impl FreeCurve {
    /// Reads `extends=PartialLeak; knots=Q; over=dp; ...`. Errors: the entry that cannot be read.
    pub fn read(text: &str) -> Result<FreeCurve, String> {
        let mut curve = FreeCurve::default();
        for entry in text.split(';').map(str::trim).filter(|e| !e.is_empty()) {
            let wrong = || format!("cannot read the entry `{entry}`");
            let (key, value) = entry.split_once('=').ok_or_else(wrong)?;
            let value = value.trim().to_owned();
            match key.trim() {
                "extends" => curve.extends = value,
                "knots" => curve.knots = value,
                "count" => curve.count = Some(value),
                "over" => curve.over = value,
                "from" => curve.from = Some(value),
                "to" => curve.to = value,
                "zero" => curve.is_zero_at_zero = value == "true",
                "anchored" => curve.is_anchored = value == "true",
                "equation" => curve.equations.push(value),
                _ => return Err(wrong()),
            }
        }
        Ok(curve)
    }

    /// Places of the `n` knots between these ends that are amplitudes.
    pub fn places(&self, n: usize, (low, high): (f64, f64)) -> Vec<f64> {
        if self.is_anchored {
            return (1..=n).map(|k| low + (high - low) * k as f64 / n as f64).collect();
        }
        let least = if self.is_zero_at_zero { high / n as f64 } else { low };
        let first = if low < high { low.max(least) } else { least };
        (0..n).map(|k| first + (high - first) * k as f64 / (n - 1).max(1) as f64).collect()
    }

    /// The point of the curve that is no amplitude, if its first knot is at `low`.
    pub fn fixed_point(&self, low: f64) -> Option<(f64, f64)> {
        match (self.is_anchored, self.is_zero_at_zero) {
            (true, _) => Some((low, 0.0)),
            (false, true) => Some((0.0, 0.0)),
            (false, false) => None,
        }
    }

    /// Its variable is counted from the middle of its range.
    pub fn is_centred(&self) -> bool {
        self.from.is_some() && !self.is_zero_at_zero
    }
}

/// A formula that may stand for a free curve.
#[derive(Clone, Debug)]
pub struct Formula {
    /// The curve, by its position in the catalogue.
    pub curve: usize,
    /// Its form.
    pub form: &'static Form,
    /// The declaration of its class.
    pub source: String,
}

/// A sum of terms with shape parameters.
#[derive(Debug)]
pub struct Form {
    /// How its class is called.
    pub name: &'static str,
    /// Each is multiplied by an amplitude of its own.
    pub terms: &'static [Term],
    /// Their shape parameters: name, values to start from, and the range that is searched.
    pub shapes: &'static [Shape],
    /// It is 0 at 0.
    pub is_zero_at_zero: bool,
}

impl Form {
    /// One of its terms is constant.
    pub fn has_constant(&self) -> bool {
        self.terms.iter().any(|t| t.modelica == ONE.modelica)
    }

    /// Another form is the same less its value at 0.
    fn has_twin_from_zero(&self) -> bool {
        self.terms.iter().any(|t| [DECLINE.modelica, COSINE.modelica].contains(&t.modelica))
    }

    /// It is another form less its value at 0, which is an amplitude of that form.
    fn is_twin_from_zero(&self) -> bool {
        self.terms.iter().any(|t| t.modelica == COSINE_LESS_ONE.modelica)
    }

    /// The form that this one generalizes by one more shape parameter, its last, and the value of that in the special form.
    pub fn special(&self) -> Option<(&'static str, f64)> {
        self.terms.iter().any(|t| t.modelica == HINGE_POWER.modelica).then_some(("Hinge", 1.0))
    }

    /// It is a straight line through zero at one value of its shape.
    pub fn contains_straight_line(&self) -> bool {
        matches!(self.terms, [term] if term.modelica == POWER.modelica)
    }

    /// It is a line and a square. Where a curve multiplies a parameter, it is counted from the middle of the range: at the zero
    /// of the variable, the parameter may be zero or negative.
    pub fn is_parabola(&self) -> bool {
        let is = |t: &Term| [LINE.modelica, SQUARE.modelica].contains(&t.modelica);
        self.terms.len() == 2 && self.terms.iter().all(is)
    }

    /// It is a line and a square with the sign of the variable.
    pub fn is_odd_parabola(&self) -> bool {
        let is = |t: &Term| [LINE.modelica, SIGNED_SQUARE.modelica].contains(&t.modelica);
        self.terms.len() == 2 && self.terms.iter().all(is)
    }

    /// It equals another form where the variable has only one sign.
    pub fn needs_both_signs(&self) -> bool {
        let of_magnitude = [MAGNITUDE.modelica, EVEN_POWER.modelica, EVEN_HYPERBOLA.modelica];
        let is_even = self.terms.iter().all(|t| of_magnitude.contains(&t.modelica));
        let is_hinge = self.shapes.iter().any(|s| [EDGE.name, LOWER.name].contains(&s.name));
        let is_square = self.terms.iter().any(|t| t.modelica == SQUARE.modelica);
        is_even || is_hinge || !self.has_constant() && is_square
    }

    /// It is infinite where the variable is zero, and unknown below.
    pub fn has_pole_at_zero(&self) -> bool {
        self.terms.iter().any(|t| t.modelica == INVERSE_POWER.modelica)
    }

    /// It is a single function without a shape.
    fn is_plain(&self) -> bool {
        self.terms.len() == 1 && self.shapes.is_empty()
    }

    /// It bends a straight line one way, without a place of its own along the line.
    pub fn bends_line(&self) -> bool {
        let placed = [CENTRE.name, WAVE_NUMBER.name, EDGE.name, UPPER.name];
        let is_placed = self.shapes.iter().any(|s| placed.contains(&s.name));
        !is_placed && !self.is_plain() && !self.has_constant()
    }

    /// One of its terms is proportional to the variable.
    pub fn has_line(&self) -> bool {
        self.terms.iter().any(|t| t.modelica == LINE.modelica)
    }
}

/// A function of the variable and of the shape parameters.
#[derive(Debug)]
pub struct Term {
    /// In Modelica, with `{u}` for the variable.
    pub modelica: &'static str,
    /// For people.
    pub shown: &'static str,
    /// Its value.
    pub value: fn(f64, &[f64]) -> f64,
}

/// A shape parameter.
#[derive(Debug)]
pub struct Shape {
    /// Its name.
    pub name: &'static str,
    /// Values to start from.
    pub starts: &'static [f64],
    /// The least and the greatest value; for one that keeps its sign, those of its magnitude.
    pub range: (f64, f64),
    /// It keeps the sign of its start.
    pub keeps_sign: bool,
}

impl Shape {
    /// The range in which a fit may look from a start.
    pub fn range_around(&self, start: f64) -> (f64, f64) {
        match self.keeps_sign && start < 0.0 {
            true => (-self.range.1, -self.range.0),
            false => self.range,
        }
    }
}

/// The amplitudes in order.
const AMPLITUDES: [&str; 3] = ["A", "B", "C"];

const ONE: Term = Term { modelica: "1", shown: "", value: |_, _| 1.0 };
const LINE: Term = Term { modelica: "{u}", shown: "{u}", value: |u, _| u };
const SQUARE: Term = Term { modelica: "{u}^2", shown: "{u}^2", value: |u, _| u * u };
const SIGNED_SQUARE: Term =
    Term { modelica: "{u}*noEvent(abs({u}))", shown: "{u} |{u}|", value: |u, _| u * u.abs() };
const CUBE: Term = Term { modelica: "{u}^3", shown: "{u}^3", value: |u, _| u * u * u };
const MAGNITUDE: Term =
    Term { modelica: "noEvent(abs({u}))", shown: "|{u}|", value: |u, _| u.abs() };
const EVEN_POWER: Term = Term {
    modelica: "Effects.regularPower(noEvent(abs({u})), exponent)",
    shown: "|{u}|^exponent",
    value: |u, p| u.abs().powf(p[0]),
};
const POWER: Term = Term {
    modelica: "Effects.regularPower({u}, exponent)",
    shown: "{u}^exponent",
    value: |u, p| u.signum() * u.abs().powf(p[0]),
};
const EXPONENTIAL: Term =
    Term { modelica: "exp({u}/width)", shown: "exp({u}/width)", value: |u, p| (u / p[0]).exp() };
const GROWTH: Term = Term {
    modelica: "(exp({u}/width) - 1)",
    shown: "(exp({u}/width) - 1)",
    value: |u, p| (u / p[0]).exp_m1(),
};
const SATURATION: Term =
    Term { modelica: "tanh({u}/width)", shown: "tanh({u}/width)", value: |u, p| (u / p[0]).tanh() };
const HYPERBOLA: Term = Term {
    modelica: "{u}/(width + noEvent(abs({u})))",
    shown: "{u}/(width + |{u}|)",
    value: |u, p| u / (p[0] + u.abs()),
};
const EVEN_HYPERBOLA: Term = Term {
    modelica: "noEvent(abs({u}))/(width + noEvent(abs({u})))",
    shown: "|{u}|/(width + |{u}|)",
    value: |u, p| u.abs() / (p[0] + u.abs()),
};
const LOGARITHM: Term = Term {
    modelica: "noEvent(sign({u})*log(1 + abs({u})/width))",
    shown: "sign({u}) log(1 + |{u}|/width)",
    value: |u, p| u.signum() * (u.abs() / p[0]).ln_1p(),
};
const RECIPROCAL: Term = Term {
    modelica: "(1/noEvent(max(1 - {u}/pole, 0.02)) - 1)",
    shown: "(1/(1 - {u}/pole) - 1)",
    value: |u, p| 1.0 / (1.0 - u / p[0]).max(0.02) - 1.0,
};
const INVERSE_POWER: Term = Term {
    modelica: "noEvent(max({u}, 0.01))^(-exponent)",
    shown: "{u}^(-exponent)",
    value: |u, p| u.max(0.01).powf(-p[0]),
};
const STEP: Term = Term {
    modelica: "tanh(({u} - centre)/width)",
    shown: "tanh(({u} - centre)/width)",
    value: |u, p| ((u - p[0]) / p[1]).tanh(),
};
const BELL: Term = Term {
    modelica: "exp(-(({u} - centre)/width)^2)",
    shown: "exp(-(({u} - centre)/width)^2)",
    value: |u, p| (-((u - p[0]) / p[1]).powi(2)).exp(),
};
const DECLINE: Term = Term {
    modelica: "1/(1 + ({u}/width)^2)",
    shown: "1/(1 + ({u}/width)^2)",
    value: |u, p| 1.0 / (1.0 + (u / p[0]).powi(2)),
};
const FALL: Term = Term {
    modelica: "(1/(1 + ({u}/width)^2) - 1)",
    shown: "(1/(1 + ({u}/width)^2) - 1)",
    value: |u, p| 1.0 / (1.0 + (u / p[0]).powi(2)) - 1.0,
};
const HILL: Term = Term {
    modelica: "noEvent(abs({u})^exponent/(width^exponent + abs({u})^exponent))",
    shown: "|{u}|^exponent/(width^exponent + |{u}|^exponent)",
    value: |u, p| {
        let power = u.abs().powf(p[1]);
        power / (p[0].powf(p[1]) + power)
    },
};
const SINE: Term = Term {
    modelica: "sin(wave_number*{u})",
    shown: "sin(wave_number {u})",
    value: |u, p| (p[0] * u).sin(),
};
const COSINE: Term = Term {
    modelica: "cos(wave_number*{u})",
    shown: "cos(wave_number {u})",
    value: |u, p| (p[0] * u).cos(),
};
const COSINE_LESS_ONE: Term = Term {
    modelica: "(cos(wave_number*{u}) - 1)",
    shown: "(cos(wave_number {u}) - 1)",
    value: |u, p| (p[0] * u).cos() - 1.0,
};
const HINGE: Term = Term {
    modelica: "noEvent(max(0, {u} - centre))",
    shown: "max(0, {u} - centre)",
    value: |u, p| (u - p[0]).max(0.0),
};
const HINGE_POWER: Term = Term {
    modelica: "noEvent(if {u} > centre then ({u} - centre)^exponent else 0)",
    shown: "max(0, {u} - centre)^exponent",
    value: |u, p| if u > p[0] { (u - p[0]).powf(p[1]) } else { 0.0 },
};
const DEAD_BAND: Term = Term {
    modelica: "noEvent({u} - max(-edge, min(edge, {u})))",
    shown: "({u} - max(-edge, min(edge, {u})))",
    value: |u, p| u - u.clamp(-p[0], p[0]),
};
const UPPER_HINGE: Term = Term {
    modelica: "noEvent(max(0, {u} - upper))",
    shown: "max(0, {u} - upper)",
    value: |u, p| (u - p[0]).max(0.0),
};
const LOWER_HINGE: Term = Term {
    modelica: "noEvent(min(0, {u} - lower))",
    shown: "min(0, {u} - lower)",
    value: |u, p| (u - p[1]).min(0.0),
};

const EXPONENT: Shape = Shape {
    name: "exponent",
    starts: &[0.5, 0.6, 0.7, 0.8, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0, 5.0, 7.0],
    range: (0.3, 10.0),
    keeps_sign: false,
};
const INVERSE_EXPONENT: Shape = Shape {
    name: "exponent",
    starts: &[0.5, 1.0, 1.5, 2.0, 3.0, 4.0],
    range: (0.2, 10.0),
    keeps_sign: false,
};
const HILL_EXPONENT: Shape = Shape {
    name: "exponent",
    starts: &[1.5, 2.0, 3.0, 4.0],
    range: (1.0, 10.0),
    keeps_sign: false,
};
const HINGE_EXPONENT: Shape =
    Shape { name: "exponent", starts: &[1.0], range: (0.3, 10.0), keeps_sign: false };
const SCALE: Shape = Shape {
    name: "width",
    starts: &[0.05, 0.1, 0.2, 0.4, 0.8, 1.6, -0.05, -0.1, -0.2, -0.4, -0.8, -1.6],
    range: (1e-2, 1e2),
    keeps_sign: true,
};
const WIDTH: Shape = Shape {
    name: "width",
    starts: &[0.05, 0.1, 0.2, 0.3, 0.5, 0.8, 1.2],
    range: (1e-2, 1e2),
    keeps_sign: false,
};
const KNEE: Shape = Shape {
    name: "width",
    starts: &[1e-3, 3e-3, 1e-2, 3e-2, 0.1, 0.3, 1.0],
    range: (1e-5, 1e2),
    keeps_sign: false,
};
const POLE: Shape = Shape {
    name: "pole",
    starts: &[1.1, 1.3, 1.7, 2.5, 4.0, 8.0, -1.1, -1.3, -1.7, -2.5, -4.0, -8.0],
    // Within the range of the variable there is none.
    range: (1.05, 1e2),
    keeps_sign: true,
};
const CENTRE: Shape = Shape {
    name: "centre",
    starts: &[-0.9, -0.75, -0.6, -0.45, -0.3, -0.15, 0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9],
    range: (-2.0, 2.0),
    keeps_sign: false,
};
const EDGE: Shape = Shape {
    name: "edge",
    starts: &[0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9],
    range: (1e-3, 2.0),
    keeps_sign: false,
};
const UPPER: Shape = Shape {
    name: "upper",
    starts: &[0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9],
    range: (-2.0, 2.0),
    keeps_sign: false,
};
const LOWER: Shape = Shape {
    name: "lower",
    starts: &[0.0, -0.15, -0.3, -0.45, -0.6, -0.75, -0.9],
    range: (-2.0, 2.0),
    keeps_sign: false,
};
const WAVE_NUMBER: Shape = Shape {
    name: "wave_number",
    starts: &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0],
    range: (0.2, 100.0),
    keeps_sign: false,
};

/// All forms, simple ones first.
pub(super) static FORMS: &[Form] = &[
    Form { name: "Proportional", terms: &[LINE], shapes: &[], is_zero_at_zero: true },
    Form { name: "Line", terms: &[ONE, LINE], shapes: &[], is_zero_at_zero: false },
    Form { name: "PowerLaw", terms: &[POWER], shapes: &[EXPONENT], is_zero_at_zero: true },
    Form { name: "Magnitude", terms: &[MAGNITUDE], shapes: &[], is_zero_at_zero: true },
    Form { name: "EvenPower", terms: &[EVEN_POWER], shapes: &[EXPONENT], is_zero_at_zero: true },
    Form {
        name: "LineAndSquare",
        terms: &[LINE, SIGNED_SQUARE],
        shapes: &[],
        is_zero_at_zero: true,
    },
    Form { name: "LineAndParabola", terms: &[LINE, SQUARE], shapes: &[], is_zero_at_zero: true },
    Form { name: "LineAndCube", terms: &[LINE, CUBE], shapes: &[], is_zero_at_zero: true },
    Form { name: "Growth", terms: &[GROWTH], shapes: &[SCALE], is_zero_at_zero: true },
    Form { name: "Saturation", terms: &[SATURATION], shapes: &[WIDTH], is_zero_at_zero: true },
    Form { name: "Hyperbola", terms: &[HYPERBOLA], shapes: &[WIDTH], is_zero_at_zero: true },
    Form {
        name: "EvenHyperbola",
        terms: &[EVEN_HYPERBOLA],
        shapes: &[WIDTH],
        is_zero_at_zero: true,
    },
    Form { name: "Hill", terms: &[HILL], shapes: &[WIDTH, HILL_EXPONENT], is_zero_at_zero: true },
    Form {
        name: "SaturationAndSquare",
        terms: &[SATURATION, SIGNED_SQUARE],
        shapes: &[KNEE],
        is_zero_at_zero: true,
    },
    Form { name: "Logarithm", terms: &[LOGARITHM], shapes: &[KNEE], is_zero_at_zero: true },
    Form {
        name: "LineAndSaturation",
        terms: &[LINE, SATURATION],
        shapes: &[WIDTH],
        is_zero_at_zero: true,
    },
    Form {
        name: "LineAndLogarithm",
        terms: &[LINE, LOGARITHM],
        shapes: &[WIDTH],
        is_zero_at_zero: true,
    },
    Form { name: "Reciprocal", terms: &[RECIPROCAL], shapes: &[POLE], is_zero_at_zero: true },
    Form {
        name: "InversePower",
        terms: &[INVERSE_POWER],
        shapes: &[INVERSE_EXPONENT],
        is_zero_at_zero: false,
    },
    Form { name: "DeadBand", terms: &[DEAD_BAND], shapes: &[EDGE], is_zero_at_zero: true },
    Form { name: "Fall", terms: &[FALL], shapes: &[WIDTH], is_zero_at_zero: true },
    Form {
        name: "Swing",
        terms: &[SINE, COSINE_LESS_ONE],
        shapes: &[WAVE_NUMBER],
        is_zero_at_zero: true,
    },
    Form {
        name: "LineAndDeadBand",
        terms: &[LINE, DEAD_BAND],
        shapes: &[EDGE],
        is_zero_at_zero: true,
    },
    Form { name: "Parabola", terms: &[ONE, LINE, SQUARE], shapes: &[], is_zero_at_zero: false },
    Form { name: "OffsetPower", terms: &[ONE, POWER], shapes: &[EXPONENT], is_zero_at_zero: false },
    Form {
        name: "Exponential",
        terms: &[ONE, EXPONENTIAL],
        shapes: &[SCALE],
        is_zero_at_zero: false,
    },
    Form { name: "Hinge", terms: &[HINGE], shapes: &[CENTRE], is_zero_at_zero: false },
    Form {
        name: "HingePower",
        terms: &[HINGE_POWER],
        shapes: &[CENTRE, HINGE_EXPONENT],
        is_zero_at_zero: false,
    },
    Form { name: "OffsetHinge", terms: &[ONE, HINGE], shapes: &[CENTRE], is_zero_at_zero: false },
    Form {
        name: "TwoHinges",
        terms: &[UPPER_HINGE, LOWER_HINGE],
        shapes: &[UPPER, LOWER],
        is_zero_at_zero: false,
    },
    Form { name: "Wave", terms: &[SINE, COSINE], shapes: &[WAVE_NUMBER], is_zero_at_zero: false },
    Form { name: "Decline", terms: &[DECLINE], shapes: &[WIDTH], is_zero_at_zero: false },
    Form { name: "Bell", terms: &[BELL], shapes: &[CENTRE, WIDTH], is_zero_at_zero: false },
    Form { name: "Step", terms: &[STEP], shapes: &[CENTRE, WIDTH], is_zero_at_zero: false },
    Form {
        name: "OffsetStep",
        terms: &[ONE, STEP],
        shapes: &[CENTRE, WIDTH],
        is_zero_at_zero: false,
    },
];

/// The formulas for the free curves of a catalogue: effects of their own, which no score test tries.
pub fn formulas(effects: &[Effect]) -> Vec<Effect> {
    let mut out = Vec::new();
    for (k, effect) in effects.iter().enumerate() {
        let Some(curve) = effect.curve.as_ref().filter(|_| effect.finer_than.is_none()) else {
            continue;
        };
        let fits = |form: &&Form| match () {
            // A straight line has a class of its own.
            () if curve.is_anchored => {
                !form.has_constant() && !form.has_twin_from_zero() && !form.is_plain()
            }
            () if curve.is_zero_at_zero => form.is_zero_at_zero,
            () => !form.is_twin_from_zero(),
        };
        out.extend(FORMS.iter().filter(fits).map(|form| formula(k, effect, curve, form)));
    }
    out
}

fn formula(k: usize, effect: &Effect, curve: &FreeCurve, form: &'static Form) -> Effect {
    let (package, own) = effect.class.rsplit_once('.').unwrap_or(("", &effect.class));
    let class = format!("{}{}", own.strip_prefix("Free").unwrap_or(own), form.name);
    let unit = |name: &str| {
        let found = effect.units.iter().find(|(n, _)| n == name);
        found.map_or("1", |(_, u)| u.as_str())
    };
    let (x, amplitude) = (unit(&curve.over), unit(&format!("{}[1]", curve.knots)));
    let (scale, middle) = (scale_name(curve), middle_name(curve));
    let law = law(effect, curve, form);
    let mut source = format!("  model {class} \"{law}\"\n");
    let base = if package.is_empty() { String::new() } else { format!("{package}.") };
    source.push_str(&format!("    extends {base}{};\n", curve.extends));
    let mut parameter = |name: &str, unit: &str, value: &str, about: &str| {
        let line = format!("    parameter Real {name}(unit = \"{unit}\") = {value} \"{about}\";\n");
        source.push_str(&line);
    };
    for name in AMPLITUDES.iter().take(form.terms.len()) {
        parameter(name, amplitude, "0", "Amplitude");
    }
    for shape in form.shapes {
        parameter(shape.name, "1", "1", "Shape");
    }
    parameter(&scale, x, "1", &format!("Scale of {}", curve.over));
    if curve.is_centred() {
        parameter(&middle, x, "0", &format!("Reference value of {}", curve.over));
    }
    source.push_str("  equation\n");
    for equation in &curve.equations {
        let value = |argument: &str| modelica(form, &normalized(curve, argument));
        source.push_str(&format!("    {};\n", with_calls(equation, "F", &value)));
    }
    source.push_str(&format!("  end {class};\n"));
    let names = AMPLITUDES.iter().take(form.terms.len());
    let amplitudes = names.map(|n| Amplitude { name: (*n).to_owned(), positive: false }).collect();
    let mut units: Vec<(String, String)> = effect.units.clone();
    units.extend(AMPLITUDES.iter().map(|n| ((*n).to_owned(), amplitude.to_owned())));
    units.extend([(scale, x.to_owned()), (middle, x.to_owned())]);
    let unknown = "by a law that is not known in advance";
    Effect {
        class,
        amplitudes,
        shape_parameters: form
            .shapes
            .iter()
            .map(|s| (s.name.to_owned(), s.starts.iter().map(|v| Start::Value(*v)).collect()))
            .collect(),
        explains: effect.explains.replace(unknown, &format!("as {law}")),
        connectors: effect.connectors.clone(),
        host: effect.host.clone(),
        binds: effect.binds.clone(),
        varies: effect.varies.clone(),
        adds: effect.adds.clone(),
        acts: effect.acts.clone(),
        of_signal: effect.of_signal,
        named: Some(effect.class.clone()),
        law,
        units,
        over: effect.over.clone(),
        formula: Some(Formula { curve: k, form, source }),
        ..Effect::default()
    }
}

/// The parameter that the variable of a curve is divided by.
pub fn scale_name(curve: &FreeCurve) -> String {
    format!("{}_0", curve.over)
}

/// The parameter from which the variable of a curve is counted.
pub fn middle_name(curve: &FreeCurve) -> String {
    format!("{}_m", curve.over)
}

/// `u` for an argument.
fn normalized(curve: &FreeCurve, argument: &str) -> String {
    let scale = scale_name(curve);
    match curve.is_centred() {
        true => format!("(({argument} - {})/{scale})", middle_name(curve)),
        false => format!("({argument}/{scale})"),
    }
}

fn modelica(form: &Form, u: &str) -> String {
    let term = |(amplitude, term): (&&str, &Term)| match term.modelica {
        "1" => (*amplitude).to_owned(),
        other => format!("{amplitude}*{}", other.replace("{u}", u)),
    };
    let all: Vec<String> = AMPLITUDES.iter().zip(form.terms).map(term).collect();
    match all.as_slice() {
        [one] => one.clone(),
        several => format!("({})", several.join(" + ")),
    }
}

/// The law of a curve with a formula in the place of its unknown function.
fn law(effect: &Effect, curve: &FreeCurve, form: &Form) -> String {
    let value = |argument: &str| {
        let u = normalized(curve, argument);
        let term = |(amplitude, term): (&&str, &Term)| {
            format!("{amplitude} {}", term.shown.replace("{u}", &u)).trim_end().to_owned()
        };
        let all: Vec<String> = AMPLITUDES.iter().zip(form.terms).map(term).collect();
        match all.as_slice() {
            [one] => one.clone(),
            several => format!("({})", several.join(" + ")),
        }
    };
    with_calls(&effect.law, &curve.knots, &value)
}

/// A text in which every call `name(x)` is replaced.
fn with_calls(text: &str, name: &str, value: &dyn Fn(&str) -> String) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some(at) = call(rest, name) {
        let open = at + name.len();
        let mut depth = 0usize;
        let close = rest[open..].find(|c: char| {
            match c {
                '(' => depth += 1,
                ')' => depth -= 1,
                _ => {}
            }
            depth == 0
        });
        let Some(close) = close.map(|k| open + k) else { break };
        out.push_str(&rest[..at]);
        out.push_str(&value(&rest[open + 1..close]));
        rest = &rest[close + 1..];
    }
    out + rest
}

/// Where a call of this name begins.
fn call(text: &str, name: &str) -> Option<usize> {
    let pattern = format!("{name}(");
    text.match_indices(&pattern).map(|(k, _)| k).find(|k| {
        let before = text[..*k].chars().next_back();
        before.is_none_or(|c| !c.is_alphanumeric() && c != '_')
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flow() -> Effect {
        let text = "extends=PartialLeak; knots=Q; over=dp; from=dp_lo; to=dp_hi; zero=true; \
                    equation=m_flow = noEvent(sign(dp))*F(noEvent(abs(dp)))";
        Effect {
            class: "Effects.FreeFlow".into(),
            law: "m_flow = sign(dp) Q(|dp|)".into(),
            explains: "Air flows past %at by a law that is not known in advance.".into(),
            units: vec![("dp".into(), "Pa".into()), ("Q[1]".into(), "kg/s".into())],
            curve: Some(FreeCurve::read(text).unwrap()),
            ..Effect::default()
        }
    }

    #[test]
    fn a_power_of_the_pressure_difference() {
        let all = formulas(&[flow()]);
        let power = all.iter().find(|e| e.class == "FlowPowerLaw").unwrap();
        assert_eq!(power.law, "m_flow = sign(dp) A (|dp|/dp_0)^exponent");
        assert_eq!(power.name(), "Effects.FreeFlow");
        assert_eq!(
            power.formula.as_ref().unwrap().source,
            "  model FlowPowerLaw \"m_flow = sign(dp) A (|dp|/dp_0)^exponent\"\n\
             \x20   extends Effects.PartialLeak;\n\
             \x20   parameter Real A(unit = \"kg/s\") = 0 \"Amplitude\";\n\
             \x20   parameter Real exponent(unit = \"1\") = 1 \"Shape\";\n\
             \x20   parameter Real dp_0(unit = \"Pa\") = 1 \"Scale of dp\";\n\
             \x20 equation\n\
             \x20   m_flow = noEvent(sign(dp))*A*Effects.regularPower((noEvent(abs(dp))/dp_0), exponent);\n\
             \x20 end FlowPowerLaw;\n"
        );
    }

    #[test]
    fn a_curve_through_zero_has_no_constant() {
        let all = formulas(&[flow()]);
        assert!(all.iter().any(|e| e.class == "FlowSaturation"));
        assert!(!all.iter().any(|e| e.class == "FlowLine"));
    }

    #[test]
    fn terms_and_their_text_are_alike() {
        // 1.2 exp(-0.5/0.4) + 3, written out by hand.
        let form = FORMS.iter().find(|f| f.name == "Exponential").unwrap();
        let sum =
            3.0 * (form.terms[0].value)(0.5, &[-0.4]) + 1.2 * (form.terms[1].value)(0.5, &[-0.4]);
        assert!((sum - (3.0 + 1.2 * (-1.25_f64).exp())).abs() < 1e-15);
        assert_eq!(modelica(form, "u"), "(A + B*exp(u/width))");
    }

    #[test]
    fn calls_are_found_as_words() {
        let value = |x: &str| format!("<{x}>");
        assert_eq!(
            with_calls("f = F(g(x)) + aF(x) + F(0)", "F", &value),
            "f = <g(x)> + aF(x) + <0>"
        );
    }
}
