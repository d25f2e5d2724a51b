#pragma once

#include "arrays.h"
#include "convert.h"

#include <nanobind/nanobind.h>

namespace filasofia::python {

/// Properties that are ids of bodies or a vector, which Python has in forms of its own.
template <class T, class Member> void addId(nb::class_<T>& bound, const char* name, Member member)
{
    const std::string signature = text("def ", name, "(self) -> filasofia.BodyId | None");
    bound.def_prop_ro(
        name, [member](const T& self) { return Convert<BodyId>::make(self.*member); },
        nb::for_getter(nb::sig(signature.c_str())));
}
template <class T, class Member> void addIds(nb::class_<T>& bound, const char* name, Member member, const char* doc)
{
    const std::string signature = text("def ", name, "(self) -> list[filasofia.BodyId]");
    bound.def_prop_ro(
        name, [member](const T& self) { return Convert<std::vector<BodyId>>::make(self.*member); },
        nb::for_getter(nb::sig(signature.c_str())), doc);
}
template <class T, class Member> void addVector(nb::class_<T>& bound, const char* name, Member member, const char* doc)
{
    const std::string signature = text("def ", name, "(self) -> numpy.typing.NDArray[numpy.float64]");
    bound.def_prop_ro(
        name, [member](const T& self) { return vectorOf(self.*member); }, nb::for_getter(nb::sig(signature.c_str())),
        doc);
}

} // namespace filasofia::python
