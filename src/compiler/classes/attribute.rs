//! Bindings, attributes and prefixes of a component, from its modifications and its type.

use super::ClassGraph;
use crate::base::name::Name;
use crate::ir::ast::Causality;
use crate::ir::instance::{Declaration, Entry, InstanceId, InstanceKind, Scope};
use crate::ir::modification::{Binding, Layer, LayerSource};

/// Attributes of the predefined types (section 4.9 of the specification).
pub const ATTRIBUTES: [&str; 11] = [
    "quantity",
    "unit",
    "displayUnit",
    "min",
    "max",
    "start",
    "fixed",
    "nominal",
    "unbounded",
    "stateSelect",
    "value",
];

/// True for the name of an attribute.
pub fn is_attribute(text: Name) -> bool {
    ATTRIBUTES.contains(&text.as_str())
}

/// Whether subscripts name an element, or a row, of an array of these sizes.
pub fn is_within(subscripts: &[usize], dims: &[usize]) -> bool {
    subscripts.len() <= dims.len() && subscripts.iter().zip(dims).all(|(k, n)| (1..=*n).contains(k))
}

impl ClassGraph<'_> {
    /// The outermost binding of an instance as a whole.
    pub fn binding(&self, id: InstanceId) -> Option<Binding> {
        let layers = self.instances[id].layers.iter();
        layers.filter(|layer| self.part(id, layer).is_none()).find_map(Layer::binding)
    }

    /// The bindings of elements of an array of scalars, from outside of that of the array: subscripts and values, the
    /// innermost first.
    pub fn bindings_of_elements(&self, id: InstanceId) -> Vec<(Vec<usize>, Binding)> {
        let layers = self.instances[id].layers.iter();
        let outer = layers.take_while(|layer| !layer.binds() || self.part(id, layer).is_some());
        let found = outer.filter_map(|layer| Some((self.part(id, layer)?, layer.binding()?)));
        let mut all: Vec<_> = found.map(|(part, binding)| (part.to_vec(), binding)).collect();
        all.reverse();
        all
    }

    /// The subscripts of an override of elements of this array of scalars.
    fn part<'l>(&self, id: InstanceId, layer: &'l Layer) -> Option<&'l [usize]> {
        match &self.instances[id].kind {
            InstanceKind::Variable { dims, .. } => layer.part().filter(|s| is_within(s, dims)),
            InstanceKind::Object(_) | InstanceKind::Array { .. } => None,
            // Its sizes are being found out.
            _ => layer.part(),
        }
    }

    /// The outermost binding of an attribute of an instance of predefined type: from modifications of
    /// the component, then from its type.
    pub fn attribute(&mut self, id: InstanceId, attribute: Name) -> Option<Binding> {
        let of_component = self.attribute_layers(id, attribute);
        let mut of_whole = of_component.iter().filter(|layer| !self.is_of_element(id, layer));
        if let Some(binding) = of_whole.find_map(Layer::binding) {
            return Some(binding);
        }
        self.attribute_layers_of_type(id, attribute).iter().find_map(Layer::binding)
    }

    /// The bindings of an attribute of elements of an array of scalars, which overrides alone can give: subscripts and values.
    pub fn attributes_of_elements(
        &self,
        id: InstanceId,
        attribute: Name,
    ) -> Vec<(Vec<usize>, Binding)> {
        let layers = self.attribute_layers(id, attribute);
        let of_elements = layers.iter().filter(|layer| self.is_of_element(id, layer));
        let one = |layer: &Layer| Some((layer.part_of_holder()?.to_vec(), layer.binding()?));
        of_elements.filter_map(one).collect()
    }

    /// Whether a layer sets an attribute of elements of this array of scalars, as `a[2].start=5` does.
    fn is_of_element(&self, id: InstanceId, layer: &Layer) -> bool {
        let is_array = |dims: &[usize]| !dims.is_empty();
        matches!(&self.instances[id].kind, InstanceKind::Variable { dims, .. } if is_array(dims))
            && layer.part_of_holder().is_some()
    }

    /// The attributes that an instance of predefined type is given, some of them more than once.
    pub fn attributes_given(&mut self, id: InstanceId) -> Vec<Name> {
        let mut found = Vec::new();
        for layer in self.instances[id].layers.iter() {
            match &layer.source {
                LayerSource::ParameterOverride(s, depth) => {
                    found.extend(s.parts.get(*depth).map(|(part, _)| *part));
                }
                _ => found.extend(layer.modified_names().map(|(part, _)| part)),
            }
        }
        let table = self.table_of(id);
        for layer in &table.layers {
            found.extend(layer.modified_names().map(|(part, _)| part));
        }
        found
    }

    /// Modifications of an attribute by the component, from the outermost inwards.
    pub(crate) fn attribute_layers(&self, id: InstanceId, attribute: Name) -> Vec<Layer> {
        let mut found = Vec::new();
        for layer in self.instances[id].layers.iter() {
            layer.child(attribute, &mut found);
        }
        found
    }

    /// Modifications of an attribute by the type of an instance, from the outermost inwards.
    pub(crate) fn attribute_layers_of_type(
        &mut self,
        id: InstanceId,
        attribute: Name,
    ) -> Vec<Layer> {
        let mut found = Vec::new();
        let table = self.table_of(id);
        for layer in &table.layers {
            layer.child(attribute, &mut found);
        }
        found
    }

    /// `input` or `output`, as declared or by the type.
    pub(crate) fn causality(&mut self, entry: &Entry, d: &Declaration) -> Option<Causality> {
        let clause = d.clause();
        let fixed = clause.prefix.variability.is_some();
        if clause.prefix.causality.is_some() || entry.protected || fixed {
            return clause.prefix.causality;
        }
        let scope = self.declaration_scope(entry);
        let class = self.find_class(&clause.type_name, scope)?;
        if self.table_in_progress(class) {
            return None;
        }
        self.table(class).prefix.causality
    }

    /// The scope in which the declaration of an element looks up names.
    pub fn declaration_scope(&self, entry: &Entry) -> Scope {
        Scope { instance: self.classes[entry.class].holder, class: entry.class }
    }
}
