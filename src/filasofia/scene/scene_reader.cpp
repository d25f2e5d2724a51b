#include "filasofia/scene/scene_reader.h"

#include "filasofia/runtime/assets.h"
#include "filasofia/scene/path_within.h"

namespace filasofia::scene {
namespace {

constexpr std::size_t kMaxHinted = 40; // bytes of a wrong word that gets a hint; a list is shown up to twice that
constexpr std::string_view kAsset = "asset:";
constexpr int kClassRank = 1000; // classes have ranks below it, one for each level of nesting; defaults above it

std::string hintFor(std::string_view word, const std::vector<std::string>& known)
{
    return word.size() <= kMaxHinted ? didYouMean(word, known) : std::string();
}

std::string shown(const Json& json)
{
    if (json.is_object()) return "an object";
    const std::string all = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    return json.is_array() && all.size() > 2 * kMaxHinted ? text("a list of length ", json.size()) : shortened(all);
}

} // namespace

void SceneReader::refuse(const Json& json, const Place& place, std::string_view must, std::string_view hint) const
{
    fail(sources_.placeOf(json), ": ", place.path(), " ", must, ", got ", shown(json), hint);
}

void SceneReader::refuseWord(const Json& json, const Place& place, const std::vector<std::string>& known,
                             const std::string& hint) const
{
    const std::string given = json.is_string() ? word(json) : std::string();
    refuse(json, place, text("must be one of ", listed(known)), hint.empty() ? hintFor(given, known) : hint);
}

void SceneReader::refuseUnknown(const Json& object, const Place& place, const std::vector<std::string>& known,
                                std::string_view type) const
{
    for (const auto& item : object.items()) {
        const std::string& name = item.key();
        if (std::ranges::find(known, name) != known.end()) continue;
        fail(sources_.placeOf(item.value()), ": unknown field '", shortened(name), "' in ", place.path(),
             type.empty() ? "" : text(", a ", type),
             name.size() <= kMaxHinted ? didYouMeanOneOf(name, known) : std::string());
    }
}

void SceneReader::refuseWithout(const Json& object, const Place& place, std::string_view member,
                                std::string_view type) const
{
    fail(sources_.placeOf(object), ": ", place.path(), " must have the member '", member, "' (", type, ")");
}

std::string SceneReader::listed(const std::vector<std::string>& names)
{
    std::string out;
    for (const std::string& name : names) out += text(out.empty() ? "" : ", ", name);
    return out;
}

const Json* SceneReader::find(const Json& object, std::string_view name)
{
    if (!object.is_object()) return nullptr;
    const auto found = object.find(name);
    return found == object.end() ? nullptr : &*found;
}

Layers SceneReader::members(const Layers& layers, std::string_view name)
{
    Layers out;
    for (const Layer& layer : layers) {
        const Json* member = find(*layer.json, name);
        if (!member) continue;
        if (!out.empty() && !member->is_object()) break; // an object hides what is none
        out.push_back({member, layer.rank});
        if (!member->is_object()) break;
    }
    return out;
}

Layers SceneReader::withDefaults(const Layers& from, std::string_view type)
{
    Layers out = from;
    int rank = 0;
    for (auto open = open_.rbegin(); open != open_.rend(); ++open) {
        rank = kClassRank - static_cast<int>(open_.rend() - open); // an inner class comes before an outer one
        if (const Json* defaults = find(*open->content, type)) {
            out.push_back({defaults, rank});
            open->used = true;
        }
    }
    rank = kClassRank;
    for (const Json* each : defaults_) {
        ++rank;
        if (const Json* defaults = find(*each, type)) out.push_back({defaults, rank});
    }
    std::ranges::stable_sort(out, {}, &Layer::rank);
    return out;
}

std::size_t SceneReader::openClasses(const Layers& from, const Place& place)
{
    const std::size_t before = open_.size();
    for (const Layer& layer : from) {
        const Json* name = find(*layer.json, kClass);
        const auto same = [&](const OpenClass& open) { return open.name == name; }; // a body is read in two parts
        if (name && std::ranges::none_of(open_, same))
            open_.push_back({name, &classNamed(*name, Place{&place, kClass}), false});
    }
    return before;
}

void SceneReader::closeClasses(std::size_t before, const Place& place)
{
    for (; open_.size() > before; open_.pop_back())
        if (!open_.back().used)
            refuse(*open_.back().name, Place{&place, kClass},
                   "must be a class that says something of this object, or of one in it");
}

const Json& SceneReader::classNamed(const Json& name, const Place& place) const
{
    std::vector<std::string> known;
    for (const Json* each : classes_) {
        if (const Json* found = find(*each, word(name, place))) return *found;
        for (const auto& item : each->items()) known.push_back(item.key());
    }
    if (known.empty()) refuse(name, place, "must be a class of the scene, which has none");
    refuseWord(name, place, known);
}

OpenedObject SceneReader::open(const Layers& from, const Place& place, const ObjectShape& shape,
                               const ReadMembers& members, const std::vector<std::string>& beside)
{
    const Json& json = *from.front().json;
    if (!json.is_object()) refuse(json, place, text("must be an object (", shape.type, ")"));
    OpenedObject object{openClasses(from, place), withDefaults(from, shape.type), {}};
    for (const ReadMember& each : members)
        if (!each.name.empty()) object.known.emplace_back(each.name);
    object.known.insert(object.known.end(), {kType, kClass});
    for (const std::string& each : beside)
        if (std::ranges::find(object.known, each) == object.known.end()) object.known.push_back(each);
    if (shape.type == typeName<physics::FemMaterial>()) object.known.emplace_back(kTissue);
    if (!shape.flat)
        for (const Layer& each : object.layers) refuseUnknown(*each.json, place, object.known, shape.type);
    for (const std::string_view name : shape.required)
        if (!partial_ && SceneReader::members(object.layers, name).empty())
            refuseWithout(json, place, name, shape.type);
    return object;
}

void SceneReader::readMembers(const OpenedObject& object, const Layers& from, const Place& place,
                              const ReadMembers& members)
{
    for (const ReadMember& each : members) {
        if (each.name.empty()) {
            (this->*each.readBeside)(from, place, object.known, each.value);
            continue;
        }
        const Layers inner = SceneReader::members(object.layers, each.name);
        const Place at{&place, each.name};
        if (!inner.empty()) note(at, *inner.front().json);
        if (inner.empty())
            (this->*each.fill)(at, each.value);
        else
            (this->*each.read)(inner, at, each.bound, each.value);
    }
}

void SceneReader::checkKeyPose(const Layers& layers, const Place& place) const
{
    for (const Layer& pose : members(layers, "pose"))
        if (pose.json->is_object() && !find(*pose.json, "position"))
            refuseWithout(*pose.json, Place{&place, "pose"}, "position", typeName<KeyPose>());
}

bool SceneReader::readOneOf(const ReadAlternatives& all, const Layers& from, const Place& place, const Bound& bound,
                            const std::vector<std::string>& beside, std::string_view present, void* variant)
{
    const Json& json = *from.front().json;
    std::vector<std::string> known;
    for (const ReadAlternative& each : all)
        if (!each.type.empty()) known.emplace_back(each.type);
    const auto ofType = [&](std::string_view type) {
        const auto found = std::ranges::find(all, type, &ReadAlternative::type);
        return type.empty() || found == all.end() ? nullptr : &*found;
    };
    if (json.is_object()) {
        const Place inner{&place, kType};
        const Json* named = typeOf(from);
        const std::string type = named ? word(*named, inner) : std::string(present);
        const ReadAlternative* found = ofType(type);
        if (!found)
            named ? refuseWord(*named, inner, known)
                  : refuse(json, place, text("must have a type, one of ", listed(known)));
        (this->*found->read)(SceneReader::ofType(from, type, present), place, beside, variant);
        return false;
    }
    if (json.is_string()) {
        const std::string given = word(json);
        const ReadAlternative* found = ofType(given);
        const auto file = std::ranges::find_if(all, [](const ReadAlternative& each) { return each.readFile; });
        if (!found && file != all.end() && given.find('.') != std::string::npos) { // no type has a dot
            (this->*file->readFile)(json, place, variant);
            return false;
        }
        if (!found) {
            const bool takesMaterial = std::ranges::any_of(all, &ReadAlternative::material);
            const bool tissue = std::ranges::count(physics::tissues(), given, &physics::Tissue::name) > 0;
            refuseWord(json, place, known,
                       takesMaterial && tissue ? text(" (did you mean {\"tissue\": \"", given, "\"}?)") : "");
        }
        found->makeDefault(variant);
        return true;
    }
    const auto found =
        std::ranges::find_if(all, [&](const ReadAlternative& each) { return each.takes && each.takes(json); });
    if (found == all.end()) refuse(json, place, text("must be an object, one of ", listed(known)));
    (this->*found->readPlain)(from, place, bound, variant);
    return false;
}

const Json* SceneReader::typeOf(const Layers& layers)
{
    for (const Layer& layer : layers)
        if (const Json* named = find(*layer.json, kType)) return named;
    return nullptr;
}

Layers SceneReader::ofType(const Layers& from, std::string_view type, std::string_view present)
{
    Layers out;
    bool reached = !typeOf(from);
    for (const Layer& layer : from) {
        const Json* named = find(*layer.json, kType);
        if (named ? named->is_string() && word(*named) == type : !reached || type == present) out.push_back(layer);
        reached = reached || named;
    }
    return out;
}

const physics::Tissue* SceneReader::readTissue(const Layers& layers, const Place& place) const
{
    const Layers given = members(layers, kTissue);
    if (given.empty()) return nullptr;
    const Json& json = *given.front().json;
    const std::string name = json.is_string() ? word(json) : std::string();
    std::vector<std::string> known;
    for (const physics::Tissue& each : physics::tissues()) {
        if (each.name == name) return &each;
        known.emplace_back(each.name);
    }
    refuseWord(json, Place{&place, kTissue}, known);
}

BodyId SceneReader::bodyNamed(const Json& json, const Place& place) const
{
    const std::string name = word(json, place);
    const auto found = std::ranges::find(bodies_, name);
    if (found != bodies_.end()) return BodyId{static_cast<std::uint32_t>(found - bodies_.begin()) + 1};
    if (allRead_) refuse(json, place, "must be the name of a body of the scene", hintFor(name, allBodies_));
    const bool later = std::ranges::find(allBodies_, name) != allBodies_.end();
    refuse(json, place, "must be the name of a body before this one",
           later ? ", which is this one or comes later" : hintFor(name, allBodies_));
}

AttachmentId SceneReader::attachmentNamed(const Json& json, const Place& place) const
{
    const std::string name = word(json, place);
    const auto found = std::ranges::find(attachments_, name, &NamedAttachment::name);
    if (found != attachments_.end()) return AttachmentId{static_cast<std::uint32_t>(found - attachments_.begin()) + 1};
    std::vector<std::string> known;
    for (const NamedAttachment& each : attachments_) known.push_back(each.name);
    refuse(json, place, "must be the id of a command before this one that attaches, or \"BODY.attachments[0]\"",
           hintFor(name, known));
}

AttachmentId SceneReader::newAttachment(const Json& json, const Place& place)
{
    const std::string name = word(json, place);
    if (std::ranges::find(attachments_, name, &NamedAttachment::name) != attachments_.end())
        refuse(json, place, "must differ from those of the other attachments");
    attachments_.push_back({name});
    return AttachmentId{static_cast<std::uint32_t>(attachments_.size())};
}

void SceneReader::checkFile(const std::filesystem::path& path, const Json& json, const Place& place) const
{
    if (options_.anyFolder) return;
    if (pathWithin(std::filesystem::absolute(folder_), path).empty())
        refuse(json, place, "must be a file in the folder of the scene, also behind links (--any-folder allows all)");
}

std::string SceneReader::fileNamed(const Json& json, const Place& place)
{
    const std::string name = word(json, place);
    if (name.empty()) return name;
    if (name.find('\0') != std::string::npos)
        refuse(json, place, "must be the name of a file, without a byte of value 0");
    if (name.starts_with(kAsset)) {
        const std::filesystem::path inner(name.substr(kAsset.size()));
        if (inner.is_absolute() || std::ranges::find(inner, "..") != inner.end())
            refuse(json, place, "must be a file that comes with Filasofia");
        try {
            return runtime::asset(inner.string());
        } catch (const Error& error) {
            fail(sources_.placeOf(json), ": ", place.path(), ": ", error.what());
        }
    }
    const std::filesystem::path path = std::filesystem::absolute(sources_.fileOf(json).path).parent_path() / name;
    checkFile(path, json, place);
    std::error_code problem;
    if (!std::filesystem::exists(path, problem)) refuse(json, place, "must be a file that exists");
    named_.insert(path);
    return path.string();
}

void SceneReader::note(const Place& place, const Json& json)
{
    if (!places_) return;
    std::string path = place.path().substr(pathStart_);
    if (path.starts_with('.')) path.erase(0, 1);
    places_->emplace(std::move(path), sources_.placeOf(json));
}

SceneBody SceneReader::readBody(const Json& json, const Place& place)
{
    SceneBody body;
    places_ = &body.places;
    pathStart_ = place.path().size();
    note(place, json);
    read({{&json}}, place, {}, body);
    places_ = nullptr;
    const std::string& name = std::visit([](const auto& def) -> const std::string& { return def.name; }, body.def);
    addName(name, json, place);
    const std::size_t attachments = std::visit([](const auto& def) { return def.attachments.size(); }, body.def);
    for (std::size_t i = 0; i < attachments; ++i) attachments_.push_back({text(name, ".attachments[", i, "]")});
    return body;
}

void SceneReader::addInstrument(const SceneInstrument& instrument, const Json& json, const Place& place)
{
    addName(std::visit([](const auto& def) { return def.name; }, instrument.def), json, place);
}

void SceneReader::addName(const std::string& name, const Json& json, const Place& place)
{
    if (std::ranges::find(bodies_, name) != bodies_.end())
        fail(sources_.placeOf(json), ": ", place.path(), ".name must differ from those of the other bodies, got '",
             shortened(name), "'");
    bodies_.push_back(name);
}

TimedCommand SceneReader::readCommand(const Json& json, const Place& place)
{
    const std::size_t before = attachments_.size();
    TimedCommand command;
    read({{&json}}, place, {}, command);
    command.place = text(sources_.placeOf(json), ": ", place.path());
    if (attachments_.size() > before) attachments_.back().time = command.time;
    if (const auto* release = std::get_if<physics::Release>(&command.command))
        if (const NamedAttachment& made = attachments_.at(release->id.value - 1); command.time < made.time)
            fail(command.place, ".time must be >= ", made.time, " s, when '", made.name, "' is made, got ",
                 command.time);
    return command;
}

} // namespace filasofia::scene
