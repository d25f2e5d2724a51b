#pragma once

#include "filasofia/scene/xml_source.h"

/// What is read of SOFA's components and of their attributes, and what changes nothing.
namespace filasofia::scene {

extern const std::vector<std::string_view> kCollision;

/// Tells a component that is not read, and of one that is, the attributes that are neither read nor without effect.
void tellUnreadOf(const Element& component, XmlReader& reader);
/// The same for the attributes of a node.
void tellUnreadAttributes(const Element& element, XmlReader& reader);

/// The colour that SOFA knows by a word: "red", or "#rrggbb" with or without "aa".
std::optional<Vec3> colourNamed(std::string_view words);

} // namespace filasofia::scene
