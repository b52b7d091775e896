//! YAML as a tree of texts with their places in the file.
//!
//! A library parses it. The tree keeps no anchors: a short file with aliases can stand for an endless one.

use crate::error::{InputError, Result};
use saphyr_parser::{Event, Parser, ScanError, Span};

/// Deeper files are refused, so that no file exhausts the stack.
const DEEPEST: usize = 64;

pub(super) enum Value {
    Text(String),
    List(Vec<Node>),
    Map(Vec<(Node, Node)>),
    /// Something that stands elsewhere in the file.
    Alias,
}

pub(super) struct Node {
    pub(super) value: Value,
    /// Line and column, from 1.
    pub(super) at: (usize, usize),
}

struct Reader<'a, I> {
    file: &'a str,
    events: I,
}

fn place(span: &Span) -> (usize, usize) {
    (span.start.line(), span.start.col() + 1)
}

/// The first document of a file. An empty file is an empty text.
pub(super) fn read(file: &str, text: &str) -> Result<Node> {
    Reader { file, events: Parser::new_from_str(text) }.node(0)
}

impl<'a, I: Iterator<Item = std::result::Result<(Event<'a>, Span), ScanError>>> Reader<'_, I> {
    fn refused(&self, value: &str, problem: impl Into<String>, at: (usize, usize)) -> InputError {
        InputError::new("YAML", value, problem).in_file(self.file, Some(at))
    }

    fn event(&mut self) -> Result<(Event<'a>, Span)> {
        match self.events.next() {
            Some(Ok(event)) => Ok(event),
            Some(Err(error)) => {
                let at = (error.marker().line(), error.marker().col() + 1);
                Err(self.refused("", format!("cannot be read: {}", error.info()), at).into())
            }
            None => Ok((Event::StreamEnd, Span::default())),
        }
    }

    fn node(&mut self, depth: usize) -> Result<Node> {
        let next = self.event()?;
        self.node_from(next, depth)
    }

    fn node_from(&mut self, (event, span): (Event<'a>, Span), depth: usize) -> Result<Node> {
        let at = place(&span);
        if depth > DEEPEST {
            return Err(self.refused("", format!("is nested deeper than {DEEPEST} levels"), at).into());
        }
        let value = match event {
            Event::Scalar(text, ..) => Value::Text(text.into_owned()),
            Event::StreamEnd => Value::Text(String::new()),
            Event::Alias(_) => Value::Alias,
            Event::SequenceStart(..) => {
                let mut items = Vec::new();
                loop {
                    match self.event()? {
                        (Event::SequenceEnd, _) => break,
                        next => items.push(self.node_from(next, depth + 1)?),
                    }
                }
                Value::List(items)
            }
            Event::MappingStart(..) => {
                let mut entries = Vec::new();
                loop {
                    match self.event()? {
                        (Event::MappingEnd, _) => break,
                        next => entries.push((self.node_from(next, depth + 1)?, self.node(depth + 1)?)),
                    }
                }
                Value::Map(entries)
            }
            // Marks of the stream and the document.
            _ => return self.node(depth),
        };
        Ok(Node { value, at })
    }
}
