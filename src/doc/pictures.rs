//! The pictures of classes: files next to the pages, and diagrams of components.

/// Where pages find pictures.
pub struct Pictures<'p> {
    /// The path, relative to the pages, of a picture of the class of this name that lies next to them.
    pub own: &'p dyn Fn(&str) -> Option<String>,
    /// The diagram of a model as SVG; empty where there is none.
    pub diagram: &'p dyn Fn(&str) -> String,
}

impl Pictures<'_> {
    /// A picture of a class that lies next to the pages.
    pub fn own(&self, name: &str) -> Option<String> {
        (self.own)(name)
    }

    /// The diagram of a model; empty where there is none.
    pub fn diagram(&self, name: &str) -> String {
        (self.diagram)(name)
    }
}
