//! Values as bytes, for messages between processes of one version: strings with their lengths, numbers by their bits.

/// Builds a message.
#[derive(Clone, Default, Debug)]
pub struct Writer(pub Vec<u8>);

impl Writer {
    /// A count.
    pub fn count(&mut self, n: usize) {
        self.0.extend((n as u64).to_le_bytes());
    }

    /// A number, exactly.
    pub fn number(&mut self, x: f64) {
        self.0.extend(x.to_bits().to_le_bytes());
    }

    /// Numbers.
    pub fn numbers(&mut self, all: &[f64]) {
        self.count(all.len());
        all.iter().for_each(|x| self.number(*x));
    }

    /// A string.
    pub fn text(&mut self, text: &str) {
        self.count(text.len());
        self.0.extend(text.as_bytes());
    }

    /// Whether there is a value, and the value.
    pub fn optional<T>(&mut self, value: Option<T>, write: impl FnOnce(&mut Writer, T)) {
        self.0.push(u8::from(value.is_some()));
        if let Some(value) = value {
            write(self, value);
        }
    }
}

/// Reads a message, in the order in which it was built. `None` if it ends early or is something else.
#[derive(Clone, Copy, Debug)]
pub struct Reader<'a>(pub &'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(n)?;
        self.0 = rest;
        Some(taken)
    }

    /// A count.
    pub fn count(&mut self) -> Option<usize> {
        let bytes = self.take(8)?.try_into().ok()?;
        usize::try_from(u64::from_le_bytes(bytes)).ok()
    }

    /// A number.
    pub fn number(&mut self) -> Option<f64> {
        let bytes = self.take(8)?.try_into().ok()?;
        Some(f64::from_bits(u64::from_le_bytes(bytes)))
    }

    /// Numbers.
    pub fn numbers(&mut self) -> Option<Vec<f64>> {
        self.list(Reader::number)
    }

    /// A string.
    pub fn text(&mut self) -> Option<String> {
        let n = self.count()?;
        String::from_utf8(self.take(n)?.to_vec()).ok()
    }

    /// A list after its length.
    pub fn list<T>(&mut self, mut read: impl FnMut(&mut Self) -> Option<T>) -> Option<Vec<T>> {
        let n = self.count()?;
        // Nothing is reserved for a length that a broken message claims.
        (0..n).map(|_| read(self)).collect()
    }

    /// A value that may be absent; the outer `None` is a broken message.
    pub fn optional<T>(&mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<Option<T>> {
        match self.take(1)? {
            [0] => Some(None),
            [1] => read(self).map(Some),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_read_back_and_broken_ones_do_not() {
        let mut w = Writer::default();
        w.text("Ä b");
        w.optional(Some(-0.0), Writer::number);
        w.optional(None, Writer::number);
        w.numbers(&[1.5, f64::INFINITY]);
        let mut r = Reader(&w.0);
        assert_eq!(r.text().as_deref(), Some("Ä b"));
        let zero = r.optional(Reader::number).flatten().unwrap();
        assert!(zero == 0.0 && zero.is_sign_negative());
        assert_eq!(r.optional(Reader::number), Some(None));
        assert_eq!(r.numbers(), Some(vec![1.5, f64::INFINITY]));
        assert_eq!(r.count(), None);
        assert_eq!(Reader(&w.0[..5]).text(), None);
        assert_eq!(Reader(&[0xff; 8]).numbers(), None);
    }
}
