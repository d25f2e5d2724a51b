#pragma once

#include "filasofia/record/json_shapes.h"
#include "filasofia/record/recording.h"

#include <limits>
#include <utility>

namespace filasofia::record {

/// The path to a value inside a line, for errors: a linked list on the stack, turned into text only if something is
/// wrong.
struct Place {
    const Place* outer = nullptr;
    std::string_view name = {};
    std::size_t index = 0; ///< index in a list, if the name is empty

    [[nodiscard]] std::string path() const;
    /// Throws the Error "<path> <must be ...>, got <value>".
    [[noreturn]] void refuse(std::string_view must, const Json& got) const;
};

/// Turns JSON into values. A field that is unknown, of the wrong kind, or missing unless `missing` is set, is an Error.
class JsonReader {
public:
    std::vector<Mesh> meshes;  ///< by number
    MissingField missing = {}; ///< not empty: fields of a type that are missing have their defaults, and it is told

    template <class T> void read(const Json& json, T& out, const Place& place) const
    {
        if constexpr (std::is_same_v<T, double>)
            out = number(json, place);
        else if constexpr (std::is_same_v<T, bool>)
            out = flag(json, place);
        else if constexpr (std::is_integral_v<T>)
            out = integer<T>(json, place);
        else if constexpr (std::is_same_v<T, std::string>)
            out = word(json, place);
        else if constexpr (std::is_same_v<T, BodyId> || std::is_same_v<T, AttachmentId>)
            out.value = integer<std::uint32_t>(json, place);
        else if constexpr (std::is_enum_v<T>)
            readName(json, out, place);
        else if constexpr (IsMeshSource<T>)
            readMesh(json, out, place);
        else if constexpr (kIsOptional<T>)
            json.is_null() ? out.reset() : read(json, out.emplace(), place);
        else if constexpr (kIsShared<T>)
            out = shared<typename T::element_type>(json, place);
        else if constexpr (kIsVariant<T>)
            readNamed(json, out, place);
        else if constexpr (kIsVector<T> || kIsArray<T>)
            readList(json, out, place);
        else if constexpr (IsPlaces<T>)
            readPlaces(json, out, place);
        else
            readObject(json, out, place);
    }

    /// Reads the member of an object, which must exist.
    template <class T>
    void member(const Json& object, std::string_view name, T& out, const Place* outer = nullptr) const
    {
        read(find(object, name, outer), out, Place{outer, name});
    }
    /// Throws an Error if the object has members other than the `count` that were read; `known` says which names those
    /// have.
    template <class Known>
    static void refuseUnknown(const Json& object, std::size_t count, Known&& known, const Place* outer = nullptr)
    {
        if (object.size() == count) return;
        for (const auto& item : object.items())
            if (!known(std::string_view(item.key()))) unknown(item.key(), outer);
    }

private:
    template <class T> static const T& defaultOf() // a temporary would be uninitialized, GCC 12 says
    {
        static const T made = {};
        return made;
    }
    static const Json& find(const Json& object, std::string_view name, const Place* outer);
    [[noreturn]] static void unknown(const std::string& name, const Place* outer);
    static double number(const Json& json, const Place& place);
    static bool flag(const Json& json, const Place& place);
    static std::string word(const Json& json, const Place& place);

    template <class T> static void readName(const Json& json, T& out, const Place& place)
    {
        const auto all = names(&out);
        const auto found = std::find(all.begin(), all.end(), word(json, place));
        if (found == all.end()) place.refuse("must be the name of one of its values", json);
        out = static_cast<T>(found - all.begin());
    }
    template <class File, class... Held>
    void readMesh(const Json& json, std::variant<File, Held...>& out, const Place& place) const
    {
        if (json.is_string()) {
            out = json.get<std::string>();
            return;
        }
        const auto number = integer<std::size_t>(json, place);
        const auto take = [&](const auto* held) {
            if (held) out = *held;
            return held != nullptr;
        };
        if (number >= meshes.size() || !(take(std::get_if<Held>(&meshes[number])) || ...))
            place.refuse("must be the number of a mesh of its kind on an earlier line", json);
    }
    template <class T> static T integer(const Json& json, const Place& place)
    {
        if (json.is_number_unsigned() && std::in_range<T>(json.get<std::uint64_t>())) return json.get<T>();
        if (json.is_number_integer() && !json.is_number_unsigned() && std::in_range<T>(json.get<std::int64_t>()))
            return json.get<T>();
        using Limits = std::numeric_limits<T>;
        place.refuse(text("must be a whole number in [", Limits::min(), ", ", Limits::max(), "]"), json);
    }
    template <class Held> std::shared_ptr<Held> shared(const Json& json, const Place& place) const
    {
        std::remove_const_t<Held> held;
        read(json, held, place);
        return std::make_shared<Held>(std::move(held));
    }
    template <class... Each> void readNamed(const Json& json, std::variant<Each...>& out, const Place& place) const
    {
        if (!json.is_object() || json.size() != 1) place.refuse("must be an object with one member", json);
        const std::string& name = json.begin().key();
        if (!(readAs<Each>(name, json.begin().value(), out, place) || ...)) unknown(name, &place);
    }
    template <class T, class Variant>
    bool readAs(std::string_view name, const Json& json, Variant& out, const Place& place) const
    {
        if (name != typeName<T>()) return false;
        read(json, out.template emplace<T>(), Place{&place, name});
        return true;
    }
    template <class List> void readList(const Json& json, List& out, const Place& place) const
    {
        if (!json.is_array()) place.refuse("must be a list", json);
        if constexpr (kIsVector<List>)
            out.resize(json.size());
        else if (json.size() != out.size())
            place.refuse(text("must be a list of length ", out.size()), json);
        for (std::size_t i = 0; i < out.size(); ++i) read(json[i], out[i], Place{&place, {}, i});
    }
    template <class T> void readPlaces(const Json& json, T& out, const Place& place) const
    {
        if (!json.is_array() || json.size() != fieldCount<T>())
            place.refuse(text("must be a list of length ", fieldCount<T>()), json);
        std::size_t i = 0;
        forEachField<T>([&](const auto& each) { read(json[i++], out.*(each.member), Place{&place, each.name}); });
    }
    template <class T> void readObject(const Json& json, T& out, const Place& place) const
    {
        if (!json.is_object()) place.refuse("must be an object", json);
        std::size_t index = 0;
        std::size_t read = 0;
        forEachField<T>([&](const auto& each) {
            const bool added = index++ >= firstFields<T>();
            if ((added || missing) && !json.contains(std::string(each.name))) {
                if (!added) missing(text(typeName<T>(), ".", each.name));
                out.*(each.member) = defaultOf<T>().*(each.member);
                return;
            }
            ++read;
            member(json, each.name, out.*(each.member), &place);
        });
        const auto known = [](std::string_view name) {
            bool found = false;
            forEachField<T>([&](const auto& each) { found = found || each.name == name; });
            return found;
        };
        refuseUnknown(json, read, known, &place);
    }
};

} // namespace filasofia::record
