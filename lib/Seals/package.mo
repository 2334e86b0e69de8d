within;
package Seals "Translational seals: friction, push-in force and opening at a control edge"

  type Contact = enumeration(
    Free        "never touches the housing",
    CloseOnly   "touches it over the whole stroke",
    CloseToOpen "touches it up to the control edge, free beyond",
    OpenToClose "free up to the control edge, touches beyond")
    "Contact of a seal with the housing as the stroke grows from 0";

  // The roles of components in the animation of a report: a seal is a component with a contact and a control edge.
  annotation(__mocc(view =
    "seal.contact = contact; seal.never = Free; seal.always = CloseOnly; seal.below = CloseToOpen; seal.above = OpenToClose; seal.edge = s_ce; seal.closed = closed; seal.opening = opening; seal.flow = m_flow"));
end Seals;
