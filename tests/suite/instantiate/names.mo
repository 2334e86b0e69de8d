//@ case instance_name
package P
  model Part
    Boolean here = getInstanceName() == "Top.parts[2].inside";
  end Part;
  model Holder
    Part inside;
  end Holder;
  model Top
    Holder parts[2];
  end Top;
end P;
//@ expect parts[1].inside.here, parts[2].inside.here = 0, 1
