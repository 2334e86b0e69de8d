within;
package Seals "Translational seals: friction, push-in force and opening at a control edge"

  type Contact = enumeration(
    Free        "never touches the housing",
    CloseOnly   "touches it over the whole stroke",
    CloseToOpen "touches it up to the control edge, free beyond",
    OpenToClose "free up to the control edge, touches beyond")
    "Contact of a seal with the housing as the stroke grows from 0";
end Seals;
