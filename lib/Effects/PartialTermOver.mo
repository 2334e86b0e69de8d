within Effects;
partial model PartialTermOver "A term that depends on a variable"
  extends PartialTerm;
  input Real x "Variable that the term depends on";
end PartialTermOver;
