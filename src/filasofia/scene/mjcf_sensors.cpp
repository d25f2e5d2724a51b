#include "filasofia/scene/mjcf_sensors.h"

#include "filasofia/core/word.h"

#include <set>

namespace filasofia::scene {
namespace {

const std::set<std::string_view> kOfJoint = {"jointpos", "jointvel", "jointactuatorfrc"};
const std::set<std::string_view> kOfActuator = {"actuatorpos", "actuatorvel", "actuatorfrc"};

/// What a map has under the name that an attribute of the sensor says. Nothing, and told, if it has none: what has the
/// name may be of a kind that is not read.
template <class Map> auto named(XmlReader& reader, const Element& sensor, const char* attribute, const Map& map)
    -> const typename Map::mapped_type*
{
    const auto name = Attributes(sensor).find(attribute);
    if (!name) reader.refuse(sensor, text("must say its ", attribute));
    if (const auto found = map.find(name->words); found != map.end()) return &found->second;
    reader.tell(sensor, text("sensor of ", name->words),
                text("<", sensor.tag(), "> of '", shortened(name->words),
                     "' is not read: nothing that is read has this name", nearestIn(map, name->words)));
    return nullptr;
}

} // namespace

std::vector<prefab::SensorDef> MjcfSensors::read()
{
    std::vector<prefab::SensorDef> all;
    Names names;
    for (const Element& section : source_.sections("sensor"))
        for (const Element& each : source_.childrenOf(section)) {
            auto kind = kindOf(each);
            if (!kind) continue;
            const std::string name = reader_.word(Attributes(each), "name");
            all.push_back(
                {.name = names.take(name.empty() ? std::string(each.tag()) : name), .kind = std::move(*kind)});
        }
    return all;
}

std::optional<prefab::SensorKind> MjcfSensors::kindOf(const Element& sensor)
{
    const std::string_view tag = sensor.tag();
    const bool joint = kOfJoint.contains(tag), actuator = kOfActuator.contains(tag);
    if (joint || actuator) {
        reader_.tellUnread(sensor, {"name", "joint", "actuator", "user"});
        const Joint* found = joint ? named(reader_, sensor, "joint", bodies_.joints)
                                   : named(reader_, sensor, "actuator", bodies_.actuators);
        if (!found) return {};
        return ofJoint(*found);
    }
    if (tag == "framepos" || tag == "framelinvel") return ofFrame(sensor);
    if (tag == "touch") return ofTouch(sensor);
    reader_.tell(sensor, text("sensor ", tag), text("<", shortened(tag), "> of <sensor> is not read"));
    return {};
}

std::optional<prefab::SensorKind> MjcfSensors::ofJoint(const Joint& joint) const
{
    if (!bodyOf_[joint.first]) return {};
    return prefab::JointSensor{.body = bodyOf_[joint.first], .joint = static_cast<int>(joint.second)};
}

std::optional<MjcfPlace> MjcfSensors::placeOf(const Element& sensor)
{
    const Attributes says(sensor);
    const std::size_t type = reader_.oneOf(says, "objtype", 0, {"body", "xbody", "geom", "site", "camera"});
    if (type == 4) {
        reader_.tell(sensor, "sensor of a camera", text("<", sensor.tag(), "> of a camera is not read"));
        return {};
    }
    const MjcfPlace* found = named(reader_, sensor, "objname",
                                   type == 2   ? bodies_.geomPlaces
                                   : type == 3 ? bodies_.sitePlaces
                                               : bodies_.bodyPlaces);
    if (!found) return {};
    MjcfPlace place = *found;
    if (type != 0) return place; // "body" is its centre of mass
    const physics::RigidInertia& inertia = bodies_.trees[place.tree].inertias[static_cast<std::size_t>(place.link)];
    if (place.pose != Pose{} || !(inertia.mass > 0.0))
        reader_.note(
            sensor, "sensor of a fixed body",
            "a sensor of a <body> that no joint moves reads the centre of all that is fixed together, or its origin");
    if (inertia.mass > 0.0) place.pose.position = inertia.centre;
    return place;
}

std::optional<prefab::SensorKind> MjcfSensors::ofFrame(const Element& sensor)
{
    reader_.tellUnread(sensor, {"name", "objtype", "objname", "user"}); // not in the frame of something else
    const std::optional<MjcfPlace> found = placeOf(sensor);
    if (!found) return {};
    const MjcfPlace& place = *found;
    const BodyId body = bodyOf_[place.tree];
    const RigidTree& tree = bodies_.trees[place.tree];
    if (!body) {
        reader_.tell(sensor, "sensor of nothing", "a sensor of what neither moves, touches nor shows is not read");
        return {};
    }
    if (sensor.tag() == "framepos")
        return prefab::PositionSensor{.body = body, .element = place.link, .tip = place.pose.position};
    const bool centre = tree.def.dynamic && place.link == 0; // what VelocitySensor reads
    const Vec3 read = centre ? tree.inertias[0].centre : Vec3{};
    if (distance(read, place.pose.position) > 1e-9)
        reader_.note(sensor, text("framelinvel ", centre),
                     centre ? "<framelinvel> is read as the velocity of the body's centre of mass"
                            : "<framelinvel> is read as the velocity of the link's origin");
    return prefab::VelocitySensor{.body = body, .element = place.link};
}

std::optional<prefab::SensorKind> MjcfSensors::ofTouch(const Element& sensor)
{
    reader_.tellUnread(sensor, {"name", "site", "user"});
    const MjcfPlace* found = named(reader_, sensor, "site", bodies_.sitePlaces);
    if (!found) return {};
    const MjcfPlace& place = *found;
    const RigidTree& tree = bodies_.trees[place.tree];
    if (tree.links() > 1 || tree.def.collision.empty() || !bodyOf_[place.tree]) {
        reader_.tell(sensor, "touch", "<touch> is read for a body of one link that collides");
        return {};
    }
    reader_.note(sensor, "touch of all", "<touch> is read as all contacts of its body, in the site or not");
    return prefab::ContactForceSensor{.body = bodyOf_[place.tree]};
}

} // namespace filasofia::scene
