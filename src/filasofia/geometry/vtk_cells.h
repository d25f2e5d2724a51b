#pragma once

#include "filasofia/geometry/raw_surface.h"
#include "filasofia/geometry/raw_tet_mesh.h"

#include <algorithm>
#include <string>
#include <vector>

namespace filasofia::geometry {

/// A list of one number per cell, by its name.
struct CellNumbers {
    std::string name;
    std::vector<int> whole; ///< per cell; empty: its numbers are no whole ones
};

/// The cells of one of VTK's unstructured grids, as a file has them.
struct VtkCells {
    std::vector<std::size_t> places;        ///< per cell, as NumberSource::place()
    std::vector<std::int64_t> connectivity; ///< the nodes of all cells
    std::vector<std::int64_t> offsets;      ///< per cell: where its nodes begin; then the end of the last
    std::vector<std::int64_t> types;        ///< per cell
    std::vector<CellNumbers> numbers;       ///< in the order of the file
    /// Whether some list can be the labels: then what is no number in a later one only tells that it cannot.
    [[nodiscard]] bool haveLabels() const
    {
        return std::ranges::any_of(numbers, [](const CellNumbers& each) { return !each.whole.empty(); });
    }
};

/// Throws an Error at `place` if the offsets do not ascend from 0 to the end of the connectivity.
void checkOffsets(const VtkCells& cells, const NumberSource& file, std::size_t place);

/// The list that loadTetMesh() takes for labels, `asked` being its argument; null: none. The log says which if there
/// are several. Throws an Error that begins with `file`, and names the lists that there are, if there is no such list.
const CellNumbers* labelsAmong(const VtkCells& cells, const std::string& asked, std::string_view file);

/// Adds the tetrahedra of the cells, with these labels, if there are any. Points, lines and surfaces have no volume and
/// are left out; throws an Error for any other cell that cannot be split.
void addCells(const VtkCells& cells, const CellNumbers* labels, const NumberSource& file, RawTetMesh& mesh);

/// Adds the polygons of a grid's cells. Points and lines bound no surface and are left out, solids are counted; throws
/// an Error for any other cell. Polydata has no types of cells: each is a polygon.
void addPolygons(const VtkCells& cells, const NumberSource& file, RawSurface& surface);

} // namespace filasofia::geometry
