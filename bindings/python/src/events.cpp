#include "results.h"

#include "arrays.h"
#include "convert.h"

#include "filasofia/core/error.h"

namespace filasofia::python {
namespace {

using runtime::ContactEvent;

/// A class of events with what all of them have.
template <class E> nb::class_<E> eventClass(nb::module_& module, const char* name, const char* doc)
{
    nb::class_<E> bound(module, name, doc);
    bound.def_prop_ro(
        "time", [](const E& self) { return self.time; }, "[s], simulated");
    bound.def_prop_ro(
        "step", [](const E& self) { return self.step; }, "number of steps completed");
    return bound;
}

const char* kindOf(const ContactEvent& touch)
{
    switch (touch.kind) {
    case ContactEvent::Kind::Begin:
        return "begin";
    case ContactEvent::Kind::Persist:
        return "persist";
    case ContactEvent::Kind::End:
        break;
    }
    return "end";
}

} // namespace

void bindEvents(nb::module_& module)
{
    const auto id = [](const char* name) { return text("def ", name, "(self) -> filasofia.BodyId"); };
    auto contact = eventClass<ContactEvent>(module, "ContactEvent", "Two bodies touch; kind is begin, persist or end.");
    contact.def_prop_ro("kind", &kindOf)
        .def_prop_ro(
            "first", [](const ContactEvent& self) { return Convert<BodyId>::make(self.pair.first); },
            nb::for_getter(nb::sig(id("first").c_str())))
        .def_prop_ro(
            "second", [](const ContactEvent& self) { return Convert<BodyId>::make(self.pair.second); },
            nb::for_getter(nb::sig(id("second").c_str())))
        .def_prop_ro(
            "contacts", [](const ContactEvent& self) { return self.pair.contacts; }, "with a normal force")
        .def_prop_ro(
            "force", [](const ContactEvent& self) { return vectorOf(self.pair.force); },
            nb::for_getter(nb::sig("def force(self) -> numpy.typing.NDArray[numpy.float64]")), "[N] on the first body")
        .def_prop_ro(
            "normal_force", [](const ContactEvent& self) { return self.pair.normalForce; }, "[N]")
        .def_prop_ro(
            "friction_force", [](const ContactEvent& self) { return self.pair.frictionForce; }, "[N]")
        .def("__repr__", [](const ContactEvent& self) {
            return text("ContactEvent(", kindOf(self), ", first=", self.pair.first.value,
                        ", second=", self.pair.second.value, ", normal_force=", self.pair.normalForce, ")");
        });
    eventClass<runtime::CutEvent>(module, "CutEvent", "A blade cut a body.")
        .def_ro("rupture", &runtime::CutEvent::rupture);
    eventClass<runtime::TearEvent>(module, "TearEvent", "Stress tore a body.")
        .def_ro("rupture", &runtime::TearEvent::rupture);
    eventClass<runtime::IntersectionEvent>(module, "IntersectionEvent",
                                           "Surfaces of two bodies begin or cease to pass through each other.")
        .def_prop_ro("kind",
                     [](const runtime::IntersectionEvent& self) {
                         return self.kind == runtime::IntersectionEvent::Kind::Begin ? "begin" : "end";
                     })
        .def_ro("intersection", &runtime::IntersectionEvent::intersection)
        .def("__repr__", [](const runtime::IntersectionEvent& self) {
            const physics::Intersection& now = self.intersection;
            return text("IntersectionEvent(kind='",
                        self.kind == runtime::IntersectionEvent::Kind::Begin ? "begin" : "end",
                        "', first=", now.first.value, ", second=", now.second.value, ", crossings=", now.crossings,
                        ", depth=", now.depth, ")");
        });
    eventClass<runtime::BleedingEvent>(module, "BleedingEvent", "How much blood a body has lost.")
        .def_prop_ro(
            "body", [](const runtime::BleedingEvent& self) { return Convert<BodyId>::make(self.body); },
            nb::for_getter(nb::sig(id("body").c_str())))
        .def_ro("balance", &runtime::BleedingEvent::balance);
    eventClass<runtime::BurnEvent>(module, "BurnEvent", "How much of a body is burnt.")
        .def_prop_ro(
            "body", [](const runtime::BurnEvent& self) { return Convert<BodyId>::make(self.body); },
            nb::for_getter(nb::sig(id("body").c_str())))
        .def_ro("target", &runtime::BurnEvent::target)
        .def_ro("injury", &runtime::BurnEvent::injury)
        .def_ro("balance", &runtime::BurnEvent::balance);
    eventClass<runtime::EnergyEvent>(module, "EnergyEvent", "What an electrode has done.")
        .def_prop_ro(
            "body", [](const runtime::EnergyEvent& self) { return Convert<BodyId>::make(self.body); },
            nb::for_getter(nb::sig(id("body").c_str())))
        .def_ro("electrode", &runtime::EnergyEvent::electrode)
        .def_ro("active", &runtime::EnergyEvent::active)
        .def_ro("balance", &runtime::EnergyEvent::balance);
    eventClass<runtime::DuctEvent>(module, "DuctEvent", "What flows in a duct.")
        .def_prop_ro(
            "body", [](const runtime::DuctEvent& self) { return Convert<BodyId>::make(self.body); },
            nb::for_getter(nb::sig(id("body").c_str())))
        .def_ro("duct", &runtime::DuctEvent::duct)
        .def_ro("balance", &runtime::DuctEvent::balance);
    eventClass<runtime::ClipEvent>(module, "ClipEvent", "A clip was closed, or slipped off.")
        .def_ro("change", &runtime::ClipEvent::change);
    eventClass<runtime::BreakEvent>(module, "BreakEvent", "Points of an attachment or a grasp let go.")
        .def_ro("attachment", &runtime::BreakEvent::attachment);
    eventClass<runtime::DistensionEvent>(module, "DistensionEvent", "What has become of the fluid in a cavity.")
        .def_ro("balance", &runtime::DistensionEvent::balance);
    eventClass<runtime::FileFailedEvent>(module, "FileFailedEvent", "A file that the run writes takes no more data.")
        .def_ro("problem", &runtime::FileFailedEvent::problem);
    eventClass<event::PhysicsUpdateEvent>(module, "PhysicsUpdateEvent", "A step is done.");
}

std::size_t alternativeOf(nb::handle given)
{
    const nb::handle classes[] = {nb::type<ContactEvent>(),
                                  nb::type<runtime::CutEvent>(),
                                  nb::type<runtime::TearEvent>(),
                                  nb::type<runtime::IntersectionEvent>(),
                                  nb::type<runtime::BleedingEvent>(),
                                  nb::type<runtime::BurnEvent>(),
                                  nb::type<runtime::EnergyEvent>(),
                                  nb::type<runtime::DuctEvent>(),
                                  nb::type<runtime::ClipEvent>(),
                                  nb::type<runtime::BreakEvent>(),
                                  nb::type<runtime::DistensionEvent>(),
                                  nb::type<runtime::FileFailedEvent>(),
                                  nb::type<event::PhysicsUpdateEvent>()};
    static_assert(std::size(classes) == std::variant_size_v<Arrived>);
    for (std::size_t i = 0; i < std::size(classes); ++i)
        if (given.is(classes[i])) return i;
    throw nb::type_error(
        text("on: the event must be ContactEvent, CutEvent, TearEvent, IntersectionEvent, BleedingEvent, "
             "BurnEvent, EnergyEvent, DuctEvent, ClipEvent, BreakEvent, DistensionEvent, FileFailedEvent or "
             "PhysicsUpdateEvent, got ",
             shown(given))
            .c_str());
}

nb::object eventObject(Arrived&& event)
{
    return std::visit([](auto&& each) { return nb::cast(std::move(each)); }, std::move(event));
}

} // namespace filasofia::python
