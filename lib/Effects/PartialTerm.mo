within Effects;
partial model PartialTerm "A term that an equation lacks"
  // The annotation `adds` of an amended model says which equation the term is added to: on the side opposite of the rate,
  // so that a positive term increases it.
  Real term "The term, in the unit of the equation";
end PartialTerm;
