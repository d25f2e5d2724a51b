#pragma once

#include "filasofia/record/json_shapes.h"

#include <bit>
#include <cmath>

namespace filasofia::record {

/// Turns values into JSON. Numbers come out in full: read back they have the same bits.
class JsonWriter {
public:
    template <class T> Json write(const T& value)
    {
        if constexpr (std::is_same_v<T, double>)
            return number(value);
        else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string>)
            return value;
        else if constexpr (std::is_same_v<T, BodyId>)
            return value.value;
        else if constexpr (std::is_same_v<T, TetMesh>)
            return numberOf(value);
        else if constexpr (std::is_same_v<T, physics::TetMeshSource>)
            return std::visit([this](const auto& source) { return this->write(source); }, value);
        else if constexpr (kIsOptional<T>)
            return value ? write(*value) : Json();
        else if constexpr (kIsShared<T>)
            return write(*value);
        else if constexpr (kIsVariant<T>)
            return std::visit([this](const auto& held) { return this->named(held); }, value);
        else if constexpr (kIsVector<T> || kIsArray<T>)
            return list(value);
        else
            return object(value);
    }

    /// The meshes that were met and not handed out yet; their numbers go on from one call to the next.
    std::vector<TetMesh> takeNewMeshes()
    {
        std::vector<TetMesh> fresh(meshes_.begin() + static_cast<std::ptrdiff_t>(handedOut_), meshes_.end());
        handedOut_ = meshes_.size();
        return fresh;
    }

private:
    static Json number(double value)
    {
        if (std::isinf(value)) return value > 0 ? kInfinite : kMinusInfinite;
        if (std::isnan(value)) fail("a recording holds no number that is none (NaN)");
        return value;
    }
    template <class T> Json named(const T& held)
    {
        Json json = Json::object();
        json[std::string(typeName<T>())] = write(held);
        return json;
    }
    template <class List> Json list(const List& values)
    {
        Json json = Json::array();
        for (const auto& each : values) json.push_back(write(each));
        return json;
    }
    template <HasFields T> Json object(const T& value)
    {
        Json json = IsPlaces<T> ? Json::array() : Json::object();
        forEachField<T>([&](const auto& each) {
            if constexpr (IsPlaces<T>)
                json.push_back(write(value.*(each.member)));
            else
                json[std::string(each.name)] = write(value.*(each.member));
        });
        return json;
    }

    static bool sameBits(const geometry::TetMesh& a, const geometry::TetMesh& b)
    {
        const auto same = [](Vec3 p, Vec3 q) {
            const auto bits = [](Vec3 v) { return std::bit_cast<std::array<std::uint64_t, 3>>(v); };
            return bits(p) == bits(q);
        };
        return a.tetrahedra == b.tetrahedra &&
               std::equal(a.nodes.begin(), a.nodes.end(), b.nodes.begin(), b.nodes.end(), same);
    }
    std::size_t numberOf(const TetMesh& mesh)
    {
        if (!mesh) fail("a recording holds no body without a mesh");
        for (std::size_t i = 0; i < meshes_.size(); ++i)
            if (meshes_[i] == mesh || sameBits(*meshes_[i], *mesh)) return i;
        meshes_.push_back(mesh);
        return meshes_.size() - 1;
    }

    std::vector<TetMesh> meshes_;
    std::size_t handedOut_ = 0;
};

} // namespace filasofia::record
