#pragma once

#include "filasofia/core/error.h"
#include "filasofia/core/suggestion.h"
#include "filasofia/core/word.h"
#include "filasofia/physics/tissue.h"
#include "filasofia/record/json_reader.h"
#include "filasofia/scene/read_parts.h"
#include "filasofia/scene/scene_file.h"

#include <algorithm>
#include <limits>
#include <map>
#include <set>
#include <span>

namespace filasofia::scene {

/// Turns the JSON of scene files into Defs. Strict: an unknown field or a wrong value is an Error with its place in the
/// file; what is missing keeps its default.
class SceneReader {
public:
    SceneReader(const JsonSources& sources, std::filesystem::path folder, const SceneFileOptions& options)
        : sources_(sources), folder_(std::move(folder)), options_(options)
    {
    }

    /// Objects "defaults" (of Defs by their types) and "classes" (of such objects by the classes' names) of a file; the
    /// files that were added earlier are looked through first.
    void addDefaults(const Json& defaults) { defaults_.push_back(&defaults); }
    void addClasses(const Json& classes) { classes_.push_back(&classes); }
    /// Reads a default for itself, which need not say all that an object of its type must.
    template <class T> void checkDefault(const Json& json, const Place& place)
    {
        partial_ = true;
        T def{};
        read({{&json}}, place, {}, def);
        partial_ = false;
    }
    /// The names of all bodies of the scene, for errors.
    void knowBodies(std::vector<std::string> names) { allBodies_ = std::move(names); }
    /// From now on all bodies have been read, and what is read may name any.
    void endBodies() { allRead_ = true; }
    /// Reads a member of the scene, and notes where it and what is in it stand.
    template <class T>
    void readMember(const Layers& from, const Place& place, Places& places, T& out, const Bound& bound = {})
    {
        places_ = &places;
        pathStart_ = 0;
        note(place, *from.front().json);
        read(from, place, bound, out);
        places_ = nullptr;
    }
    /// The next body of the scene; returns its Def, with the place in its file.
    SceneBody readBody(const Json& json, const Place& place);
    /// Gives the instrument that was read last a number behind those of the bodies.
    void addInstrument(const SceneInstrument& instrument, const Json& json, const Place& place);
    /// The next command, after all bodies.
    TimedCommand readCommand(const Json& json, const Place& place);

    template <class T> void read(const Layers& from, const Place& place, const Bound& bound, T& out)
    {
        const Json& json = *from.front().json;
        if constexpr (std::is_same_v<T, double>)
            out = number(json, place, bound);
        else if constexpr (std::is_same_v<T, bool>)
            out = flag(json, place);
        else if constexpr (std::is_integral_v<T>)
            out = static_cast<T>(whole(json, place, bound, std::numeric_limits<T>::min(),
                                       static_cast<double>(std::numeric_limits<T>::max())));
        else if constexpr (std::is_same_v<T, std::string>)
            out = word(json, place);
        else if constexpr (std::is_same_v<T, BodyId>)
            out = bodyNamed(json, place);
        else if constexpr (std::is_same_v<T, AttachmentId>)
            out = makes_ ? newAttachment(json, place) : attachmentNamed(json, place);
        else if constexpr (std::is_enum_v<T>)
            readName(json, place, out);
        else if constexpr (IsMesh<T>)
            readMesh(from, place, out);
        else if constexpr (IsFile<T>)
            out = fileNamed(json, place);
        else if constexpr (kIsOptional<T>)
            json.is_null() ? out.reset() : read(from, place, bound, out ? *out : out.emplace());
        else if constexpr (kIsVariant<T>)
            readAlternative(from, place, bound, {}, out);
        else if constexpr (kIsVector<T> || kIsArray<T>)
            readList(json, place, bound, out);
        else if constexpr (std::is_same_v<T, Quat>)
            out = rotation(json, place);
        else if constexpr (std::is_same_v<T, Vec3>)
            readNumbers(json, place, bound, std::span(&out.x, 3));
        else
            readDef(from, place, out);
    }

    /// Gives a thing that no file mentions what classes and defaults say of its type.
    template <class T> void fill(const Place& place, T& out)
    {
        if constexpr (kIsOptional<T>) {
            if (out) fill(place, *out);
        } else if constexpr (kIsVariant<T> && !IsMesh<T> && !IsFile<T>) {
            std::visit([&](auto& held) { fill(place, held); }, out);
        } else if constexpr (HasFields<T> && !IsNumbers<T>) {
            static const Json kNothing = Json::object();
            readObject({{&kNothing}}, place, {}, out);
        }
    }

    /// Throws the Error "FILE:LINE:COLUMN: <path> <must be ...>, got <value><hint>".
    [[noreturn]] void refuse(const Json& json, const Place& place, std::string_view must,
                             std::string_view hint = {}) const;
    /// Refuses members of an object other than these; `type` names its Def.
    void refuseUnknown(const Json& object, const Place& place, const std::vector<std::string>& known,
                       std::string_view type = {}) const;
    /// The file that a text names: "asset:NAME" comes with Filasofia, all others lie in the folder of the scene.
    [[nodiscard]] std::string fileNamed(const Json& json, const Place& place);
    /// The files that fileNamed() has found in the scene's folders, each once.
    [[nodiscard]] const std::set<std::filesystem::path>& named() const { return named_; }
    [[nodiscard]] static std::string word(const Json& json);
    [[nodiscard]] std::string word(const Json& json, const Place& place) const;

private:
    static constexpr const char* kType = "type";   ///< names the alternative of a variant
    static constexpr const char* kClass = "class"; ///< names a class of defaults
    static constexpr const char* kTissue = "tissue";

    [[nodiscard]] double number(const Json& json, const Place& place, const Bound& bound) const;
    [[nodiscard]] std::int64_t whole(const Json& json, const Place& place, const Bound& bound, double low,
                                     double high) const;
    [[nodiscard]] bool flag(const Json& json, const Place& place) const;
    void addName(const std::string& name, const Json& json, const Place& place);
    [[nodiscard]] BodyId bodyNamed(const Json& json, const Place& place) const;
    /// The attachment that a text names: "liver.attachments[0]", or what the command that makes it says.
    [[nodiscard]] AttachmentId attachmentNamed(const Json& json, const Place& place) const;
    [[nodiscard]] AttachmentId newAttachment(const Json& json, const Place& place);
    [[nodiscard]] Quat rotation(const Json& json, const Place& place);
    /// So many numbers: a list, or a text such as "10 20 30 mm".
    void readNumbers(const Json& json, const Place& place, const Bound& bound, std::span<double> out) const;
    [[nodiscard]] double inUnit(const Json& json, const Place& place, const Bound& bound, double value,
                                std::string_view unit) const;
    [[nodiscard]] static const Json* find(const Json& object, std::string_view name);
    /// The layers and, in their order, what the open classes and the defaults say of this type of Def.
    [[nodiscard]] Layers withDefaults(const Layers& from, std::string_view type);
    /// Opens the classes that an object names: they say something of it and of all that is in it. Returns how many
    /// were open before, for closeClasses(), which refuses one that said nothing.
    std::size_t openClasses(const Layers& from, const Place& place);
    void closeClasses(std::size_t before, const Place& place);
    [[nodiscard]] const Json& classNamed(const Json& name, const Place& place) const;
    /// The first "type" of the layers; null if they have none.
    [[nodiscard]] static const Json* typeOf(const Layers& layers);
    /// The layers that speak of this type; one without a type speaks of that of the next one with it, at last of
    /// `present`.
    [[nodiscard]] static Layers ofType(const Layers& from, std::string_view type, std::string_view present);
    void checkFile(const std::filesystem::path& path, const Json& json, const Place& place) const;

    template <class T> void readName(const Json& json, const Place& place, T& out) const
    {
        const auto all = names(&out);
        const auto found = std::ranges::find(all, std::string_view(word(json, place)));
        if (found == all.end()) refuseWord(json, place, {all.begin(), all.end()});
        out = static_cast<T>(found - all.begin());
    }
    [[noreturn]] void refuseWord(const Json& json, const Place& place, const std::vector<std::string>& known,
                                 const std::string& hint = {}) const;
    [[noreturn]] void refuseWithout(const Json& object, const Place& place, std::string_view member,
                                    std::string_view type) const;

    template <class List> void readList(const Json& json, const Place& place, const Bound& bound, List& out)
    {
        using Each = typename List::value_type;
        if constexpr (kIsArray<List> && std::is_same_v<Each, double>) {
            readNumbers(json, place, bound, out);
        } else {
            if (!json.is_array()) refuse(json, place, "must be a list");
            if constexpr (kIsVector<List>)
                out = List(json.size());
            else if (json.size() != out.size())
                refuse(json, place, text("must be a list of length ", out.size()));
            for (std::size_t i = 0; i < out.size(); ++i) {
                Each each{}; // a list of flags or numbers has no references to its members
                const Place at{&place, {}, i};
                if (json[i].is_object()) note(at, json[i]);
                read({{&json[i]}}, at, bound, each);
                out[i] = std::move(each);
            }
        }
    }

    template <class T> void readDef(const Layers& from, const Place& place, T& out)
    {
        const Json& json = *from.front().json;
        if constexpr (std::is_same_v<T, Pose>)
            if (!json.is_object()) return read(from, place, {.unit = "m"}, out.position);
        if constexpr (std::is_same_v<T, visual::Color>)
            if (!json.is_object()) return readNumbers(json, place, {.range = closed(0, 1)}, std::span(&out.red, 3));
        if constexpr (std::is_same_v<T, geometry::Box>)
            if (json.is_array()) return readCorners(json, place, out);
        readObject(from, place, {}, out);
        if constexpr (std::is_same_v<T, geometry::Box>) checkCorners(json, place, out);
        if constexpr (std::is_same_v<T, runtime::LookDef>)
            if (out.direction == Vec3{}) refuse(json, place, "must have a direction with a length > 0");
    }
    /// Notes where a member of what is read stands.
    void note(const Place& place, const Json& json);
    void readCorners(const Json& json, const Place& place, geometry::Box& out);
    void checkCorners(const Json& json, const Place& place, const geometry::Box& box) const;

    template <class T> void readValue(const Layers& from, const Place& place, const Bound& bound, void* value)
    {
        read(from, place, bound, *static_cast<T*>(value));
    }
    template <class T>
    void readBeside(const Layers& from, const Place& place, const std::vector<std::string>& known, void* value)
    {
        if constexpr (kIsVariant<T> && !IsMesh<T> && !IsFile<T>)
            readAlternative(from, place, {}, known, *static_cast<T*>(value));
        else if constexpr (HasFields<T>)
            readObject(from, place, known, *static_cast<T*>(value));
    }
    template <class T> void fillValue(const Place& place, void* value) { fill(place, *static_cast<T*>(value)); }
    template <class T> static ReadMember memberOf(std::string_view name, const Bound& bound, T& value)
    {
        return {
            name, bound, &value, &SceneReader::readValue<T>, &SceneReader::readBeside<T>, &SceneReader::fillValue<T>};
    }
    template <class T> static ReadMembers membersOf(T& object)
    {
        ReadMembers out;
        forEachField<T>([&](const auto& each) {
            out.push_back(memberOf(each.name, {each.range, each.unit}, object.*(each.member)));
        });
        return out;
    }
    [[nodiscard]] OpenedObject open(const Layers& from, const Place& place, const ObjectShape& shape,
                                    const ReadMembers& members, const std::vector<std::string>& beside);
    void readMembers(const OpenedObject& object, const Layers& from, const Place& place, const ReadMembers& members);
    void checkKeyPose(const Layers& layers, const Place& place) const;

    /// `beside`: names that are known besides the Def's own fields.
    template <class T>
    void readObject(const Layers& from, const Place& place, const std::vector<std::string>& beside, T& out)
    {
        if constexpr (std::is_same_v<T, physics::SoftBodyDef>) tissue_ = nullptr;
        const ReadMembers all = membersOf(out);
        const OpenedObject object = open(from, place, {typeName<T>(), required<T>(), kFlat<T>}, all, beside);
        if constexpr (std::is_same_v<T, physics::FemMaterial>) {
            tissue_ = readTissue(object.layers, place);
            if (tissue_) out = tissue_->material;
        }
        if constexpr (std::is_same_v<T, KeyPose>) checkKeyPose(object.layers, place);
        if constexpr (IsAnyOf<T, physics::Attach, physics::AttachRigid, physics::Grasp, physics::ApplyClip>)
            makes_ = true;
        readMembers(object, from, place, all);
        if constexpr (std::is_same_v<T, visual::TextureFile> || std::is_same_v<T, visual::CustomMaterial> ||
                      std::is_same_v<T, ScaledSurface> || std::is_same_v<T, ScaledTetrahedra>)
            if (const Layers file = members(object.layers, "file"); !file.empty())
                out.file = fileNamed(*file.front().json, Place{&place, "file"});
        makes_ = false;
        if constexpr (std::is_same_v<T, physics::SoftBodyDef>)
            if (tissue_ && members(object.layers, "mass").empty()) out.mass = physics::Density{tissue_->density};
        closeClasses(object.classes, place);
    }
    /// The members of this name; a value that is no object hides those behind it.
    [[nodiscard]] static Layers members(const Layers& layers, std::string_view name);
    /// The tissue of the library that a material begins with, or null.
    [[nodiscard]] const physics::Tissue* readTissue(const Layers& layers, const Place& place) const;

    template <class... Each> void readAlternative(const Layers& from, const Place& place, const Bound& bound,
                                                  const std::vector<std::string>& beside, std::variant<Each...>& out)
    {
        using Variant = std::variant<Each...>;
        const ReadAlternatives all = {alternative<Each, Variant>()...};
        if (readOneOf(all, from, place, bound, beside, all[out.index()].type, &out)) fill(place, out);
    }
    /// Returns whether `variant` holds an alternative with its defaults now, which must be filled.
    bool readOneOf(const ReadAlternatives& all, const Layers& from, const Place& place, const Bound& bound,
                   const std::vector<std::string>& beside, std::string_view present, void* variant);
    template <class T, class Variant> static ReadAlternative alternative()
    {
        if constexpr (HasFields<T>)
            return {.type = typeName<T>(),
                    .material = std::is_same_v<T, physics::FemMaterial>,
                    .read = &SceneReader::readAs<T, Variant>,
                    .makeDefault = [](void* variant) { *static_cast<Variant*>(variant) = T{}; },
                    .readFile = fileReader<T, Variant>()};
        else if constexpr (!kIsVariant<T>)
            return {.takes = &takes<T>, .readPlain = &SceneReader::readPlain<T, Variant>};
        else
            return {};
    }
    template <class T, class Variant> static constexpr auto fileReader()
    {
        void (SceneReader::*read)(const Json&, const Place&, void*) = nullptr;
        if constexpr (std::is_same_v<T, visual::TextureFile>) read = &SceneReader::readFile<T, Variant>;
        return read;
    }
    template <class T, class Variant> void readFile(const Json& json, const Place& place, void* variant)
    {
        *static_cast<Variant*>(variant) = T{fileNamed(json, place)};
    }
    template <class T, class Variant>
    void readAs(const Layers& from, const Place& place, const std::vector<std::string>& beside, void* variant)
    {
        Variant& out = *static_cast<Variant*>(variant);
        if (!std::holds_alternative<T>(out)) out = T{};
        if (beside.empty())
            read(from, place, {}, std::get<T>(out));
        else
            readObject(from, place, beside, std::get<T>(out));
    }
    /// Numbers and flags of a material's parameters: 1 is an integer, 1.0 a number.
    template <class T> static bool takes(const Json& json)
    {
        return std::is_same_v<T, bool>     ? json.is_boolean()
               : std::is_same_v<T, int>    ? json.is_number_integer()
               : std::is_same_v<T, double> ? json.is_number_float()
                                           : json.is_array();
    }
    template <class T, class Variant>
    void readPlain(const Layers& from, const Place& place, const Bound& bound, void* variant)
    {
        T value{};
        read(from, place, bound, value);
        *static_cast<Variant*>(variant) = value;
    }
    static std::string listed(const std::vector<std::string>& names);

    template <class Source> void readMesh(const Layers& from, const Place& place, Source& out)
    {
        const Json& json = *from.front().json;
        if (json.is_string()) {
            out = fileNamed(json, place);
            return;
        }
        if (!json.is_object()) refuse(json, place, "must be a file or an object with a type");
        if (members(from, kType).empty()) refuse(json, place, "must have a type, such as \"box\"");
        typename MeshShapes<Source>::Shapes shape;
        read(from, place, {}, shape);
        try {
            std::visit([&](const auto& each) { out = each.make(); }, shape);
        } catch (const Error& error) {
            fail(sources_.placeOf(json), ": ", place.path(), ": ", error.what());
        }
    }

    const JsonSources& sources_;
    const std::filesystem::path folder_;
    const SceneFileOptions options_;
    std::set<std::filesystem::path> named_;
    std::vector<const Json*> defaults_, classes_;
    /// A class whose object is being read.
    struct OpenClass {
        const Json* name = nullptr;
        const Json* content = nullptr;
        bool used = false;
    };
    std::vector<OpenClass> open_;             ///< the innermost last
    const physics::Tissue* tissue_ = nullptr; ///< that the material that was read last names
    bool makes_ = false;                      ///< the command that is read makes an attachment
    bool partial_ = false;                    ///< what is read need not be complete
    std::vector<std::string> bodies_;         ///< the names of those that were read, in their order
    std::vector<std::string> allBodies_;      ///< the names of all that the files have
    bool allRead_ = false;                    ///< no more bodies come
    /// An attachment of the scene.
    struct NamedAttachment {
        std::string name;
        double time = 0.0; ///< [s], when it is made
    };
    std::vector<NamedAttachment> attachments_; ///< by their numbers, from 1
    Places* places_ = nullptr;                 ///< of what is read
    std::size_t pathStart_ = 0;                ///< where its paths begin
};

} // namespace filasofia::scene
