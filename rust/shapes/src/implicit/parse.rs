//! A recursive descent parser for expressions in Python's notation.
//!
//! A sum joins terms by `+` and `-`, a term joins factors by `*` and `/`, a factor may have signs, and a power is an
//! atom followed by `** factor`. So `-x**2` is `-(x**2)` and `2**-1` is a half, as in Python.

use super::functions::{Binary, Unary};
use super::tape::{Step, Tape};

const UNARY: [(&str, Unary); 13] = [
    ("abs", Unary::Abs),
    ("sqrt", Unary::Sqrt),
    ("exp", Unary::Exp),
    ("log", Unary::Log),
    ("sin", Unary::Sin),
    ("cos", Unary::Cos),
    ("tan", Unary::Tan),
    ("asin", Unary::Asin),
    ("acos", Unary::Acos),
    ("atan", Unary::Atan),
    ("sinh", Unary::Sinh),
    ("cosh", Unary::Cosh),
    ("tanh", Unary::Tanh),
];

const BINARY: [(&str, Binary); 4] =
    [("atan2", Binary::Atan2), ("pow", Binary::Raise), ("min", Binary::Min), ("max", Binary::Max)];

const CONSTANTS: [(&str, f64); 2] = [("pi", std::f64::consts::PI), ("e", std::f64::consts::E)];

const VARIABLES: [&str; 3] = ["x", "y", "z"];

/// Maximum nesting depth of parentheses and signs.
const DEPTH: usize = 200;

/// Maximum number of steps in an expression.
const STEPS: usize = 10_000;

/// Parse an expression in x, y and z. Numbers are rounded to the nearest f64.
///
/// # Errors
///
/// A one-line message with the column, counted from 1, if the expression does not parse, uses an unknown name, or has
/// none of x, y and z.
pub fn parse(text: &str) -> Result<Tape, String> {
    let mut parser = Parser { text: text.chars().collect(), place: 0, depth: 0, tape: Tape::default() };
    let result = parser.sum()?;
    if let Some(c) = parser.peek() {
        let hint = if c == '^' { ", powers are written **" } else { "" };
        return Err(format!("unexpected {c:?} at column {}{hint}", parser.place + 1));
    }
    let mut tape = parser.tape;
    tape.finish(result);
    if tape.is_constant() {
        return Err("it uses none of x, y and z".to_owned());
    }
    Ok(tape)
}

struct Parser {
    text: Vec<char>,
    place: usize,
    depth: usize,
    tape: Tape,
}

impl Parser {
    /// The next nonblank character.
    fn peek(&mut self) -> Option<char> {
        while self.text.get(self.place).is_some_and(|c| c.is_whitespace()) {
            self.place += 1;
        }
        self.text.get(self.place).copied()
    }

    /// Consume the given characters if they come next.
    fn take(&mut self, wanted: &str) -> bool {
        self.peek();
        let here = &self.text[self.place..];
        let found = wanted.chars().enumerate().all(|(i, c)| here.get(i) == Some(&c));
        if found {
            self.place += wanted.len();
        }
        found
    }

    fn push(&mut self, step: Step) -> Result<usize, String> {
        if self.tape.len() >= STEPS {
            return Err(format!("it has more than {STEPS} steps"));
        }
        Ok(self.tape.push(step))
    }

    /// The message for a missing token.
    fn missing(&mut self, what: &str) -> String {
        match self.peek() {
            Some(c) => format!("expected {what} at column {}, got {c:?}", self.place + 1),
            None => format!("expected {what} at column {}, but the expression ends there", self.place + 1),
        }
    }

    fn sum(&mut self) -> Result<usize, String> {
        let mut left = self.term()?;
        loop {
            let function = match self.peek() {
                Some('+') => Binary::Add,
                Some('-') => Binary::Subtract,
                _ => return Ok(left),
            };
            self.place += 1;
            let right = self.term()?;
            left = self.push(Step::Binary(function, left, right))?;
        }
    }

    fn term(&mut self) -> Result<usize, String> {
        let mut left = self.factor()?;
        loop {
            let function = match self.peek() {
                Some('*') => Binary::Multiply,
                Some('/') if self.text.get(self.place + 1) != Some(&'/') => Binary::Divide,
                _ => return Ok(left),
            };
            self.place += 1;
            let right = self.factor()?;
            left = self.push(Step::Binary(function, left, right))?;
        }
    }

    fn factor(&mut self) -> Result<usize, String> {
        self.depth += 1;
        if self.depth > DEPTH {
            return Err(format!("nesting exceeds {DEPTH} levels at column {}", self.place + 1));
        }
        let result = match self.peek() {
            Some('-') => {
                self.place += 1;
                let of = self.factor()?;
                self.push(Step::Unary(Unary::Negative, of))
            }
            Some('+') => {
                self.place += 1;
                self.factor()
            }
            _ => self.power(),
        };
        self.depth -= 1;
        result
    }

    fn power(&mut self) -> Result<usize, String> {
        let base = self.atom()?;
        if !self.take("**") {
            return Ok(base);
        }
        let exponent = self.factor()?;
        self.push(Step::Binary(Binary::Raise, base, exponent))
    }

    fn atom(&mut self) -> Result<usize, String> {
        match self.peek() {
            Some('(') => {
                self.place += 1;
                let inner = self.sum()?;
                if self.take(")") { Ok(inner) } else { Err(self.missing("\")\"")) }
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            _ => Err(self.missing("a number, a name or \"(\"")),
        }
    }

    fn number(&mut self) -> Result<usize, String> {
        let start = self.place;
        let digits = |at: &mut usize, text: &[char]| {
            while text.get(*at).is_some_and(|c| c.is_ascii_digit()) {
                *at += 1;
            }
        };
        let mut end = start;
        digits(&mut end, &self.text);
        if self.text.get(end) == Some(&'.') {
            end += 1;
            digits(&mut end, &self.text);
        }
        if matches!(self.text.get(end), Some('e' | 'E')) {
            let mut power = end + 1 + usize::from(matches!(self.text.get(end + 1), Some('+' | '-')));
            if self.text.get(power).is_some_and(char::is_ascii_digit) {
                digits(&mut power, &self.text);
                end = power;
            }
        }
        // The error message includes the characters that run into the number.
        let mut all = end;
        while self.text.get(all).is_some_and(|c| c.is_alphanumeric() || *c == '_' || *c == '.') {
            all += 1;
        }
        let written: String = self.text[start..all].iter().collect();
        self.place = all;
        match written.parse::<f64>() {
            Ok(x) if x.is_finite() => self.push(Step::Constant(x)),
            _ => Err(format!("{written:?} at column {} is not a finite number", start + 1)),
        }
    }

    fn name(&mut self) -> Result<usize, String> {
        let start = self.place;
        while self.text.get(self.place).is_some_and(|c| c.is_alphanumeric() || *c == '_') {
            self.place += 1;
        }
        let name: String = self.text[start..self.place].iter().collect();
        if let Some(axis) = VARIABLES.iter().position(|v| *v == name) {
            return self.push(Step::Variable(axis));
        }
        if let Some((_, value)) = CONSTANTS.iter().find(|(n, _)| *n == name) {
            return self.push(Step::Constant(*value));
        }
        if let Some((_, function)) = UNARY.iter().find(|(n, _)| *n == name) {
            let [of] = self.arguments(&name, start)?;
            return self.push(Step::Unary(*function, of));
        }
        if let Some((_, function)) = BINARY.iter().find(|(n, _)| *n == name) {
            let [first, second] = self.arguments(&name, start)?;
            return self.push(Step::Binary(*function, first, second));
        }
        let names = VARIABLES.iter().copied().chain(CONSTANTS.iter().map(|(n, _)| *n));
        let functions = UNARY.iter().map(|(n, _)| *n).chain(BINARY.iter().map(|(n, _)| *n));
        let known: Vec<&str> = names.chain(functions).collect();
        Err(format!("unknown name '{name}' at column {}; known: {}", start + 1, known.join(", ")))
    }

    /// Parse the arguments of a function with N parameters.
    fn arguments<const N: usize>(&mut self, name: &str, start: usize) -> Result<[usize; N], String> {
        if !self.take("(") {
            return Err(format!("{name} at column {} is a function: {}", start + 1, self.missing("\"(\"")));
        }
        let mut all = Vec::new();
        if self.peek() != Some(')') {
            all.push(self.sum()?);
            while self.take(",") {
                all.push(self.sum()?);
            }
        }
        if !self.take(")") {
            return Err(self.missing("\",\" or \")\""));
        }
        let count = all.len();
        let plural = if N == 1 { "argument" } else { "arguments" };
        all.try_into().map_err(|_| format!("{name} at column {} takes {N} {plural}, got {count}", start + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str, x: f64, y: f64, z: f64) -> f64 {
        parse(text).unwrap_or_else(|e| panic!("{text}: {e}")).value(&[x, y, z], &mut Vec::new())
    }

    fn refusal(text: &str) -> String {
        parse(text).unwrap_err()
    }

    #[test]
    fn values_are_those_of_python() {
        let cases: [(&str, f64); 14] = [
            ("-x**2", -9.0),
            ("2**-y + x*0", 0.25),
            ("2**x**y", 512.0),
            ("x - y - z", -4.0),
            ("x / y / z", 0.3),
            ("-x**-2*9", -1.0),
            ("+x--y", 5.0),
            (" ( x+ y )*z\n", 25.0),
            ("pow(x, 3) - 1e1 + .5 + 2.", 19.5),
            ("max(min(x, y), 1.5) * sqrt(4)", 4.0),
            ("abs(-x) + log(exp(y)) + cos(0)*pi/pi + e/e", 7.0),
            ("atan2(0, -x) - acos(-1)", 0.0),
            ("sinh(y) - (exp(y) - exp(-y))/2 + x", 3.0),
            ("x*x - x**2 + y", 2.0),
        ];
        for (text, wanted) in cases {
            let found = value(text, 3.0, 2.0, 5.0);
            assert!((found - wanted).abs() < 1e-14, "{text} is {found}, not {wanted}");
        }
    }

    #[test]
    fn no_step_is_done_twice_or_in_vain() {
        assert_eq!(parse("(x+y)*(x+y) - (x+y)").unwrap().len(), 5);
        assert_eq!(parse("x**(-2)").unwrap().len(), 2);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_column() {
        let known = "x, y, z, pi, e, abs, sqrt, exp, log, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, \
                     atan2, pow, min, max";
        assert_eq!(refusal("x*y + foo"), format!("unknown name 'foo' at column 7; known: {known}"));
        assert_eq!(refusal("x + "), "expected a number, a name or \"(\" at column 5, but the expression ends there");
        assert_eq!(refusal("(x + 1"), "expected \")\" at column 7, but the expression ends there");
        assert_eq!(refusal("x^2"), "unexpected '^' at column 2, powers are written **");
        assert_eq!(refusal("x < 2"), "unexpected '<' at column 3");
        assert_eq!(refusal("2x"), "\"2x\" at column 1 is not a finite number");
        assert_eq!(refusal("x + 1e999"), "\"1e999\" at column 5 is not a finite number");
        assert_eq!(refusal("sin(x, y)"), "sin at column 1 takes 1 argument, got 2");
        assert_eq!(refusal("min(x)"), "min at column 1 takes 2 arguments, got 1");
        assert_eq!(refusal("1 + sin x"), "sin at column 5 is a function: expected \"(\" at column 9, got 'x'");
        assert_eq!(refusal("x // 2"), "unexpected '/' at column 3");
        assert_eq!(refusal("3 + pi"), "it uses none of x, y and z");
        assert_eq!(refusal(""), "expected a number, a name or \"(\" at column 1, but the expression ends there");
        assert!(refusal(&"(".repeat(1000)).starts_with("nesting exceeds 200 levels at column"));
        assert!(refusal(&format!("{}x", "-".repeat(1000))).starts_with("nesting exceeds"));
    }
}
