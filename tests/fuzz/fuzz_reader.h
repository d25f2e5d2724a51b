#pragma once

#include "filasofia/core/error.h"
#include "filasofia/core/log.h"
#include "filasofia/geometry/tet_mesh.h"
#include "filasofia/geometry/triangle_mesh.h"

#include <cstddef>
#include <cstdint>

namespace filasofia::geometry {

/// Calls `parse` with any bytes: it must return a mesh that passes check(), or throw an Error. If check() throws a
/// second Error, the run ends.
template <class Parse> int fuzzReader(const std::uint8_t* data, std::size_t size, const Parse& parse)
{
    setLogSink([](LogLevel, std::string_view) {});
    decltype(parse(std::string_view{})) mesh;
    try {
        mesh = parse(std::string_view{reinterpret_cast<const char*>(data), size});
    } catch (const Error&) {
        return 0;
    }
    check(mesh, "what was read");
    return 0;
}

} // namespace filasofia::geometry
