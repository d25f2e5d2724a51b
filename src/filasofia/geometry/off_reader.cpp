#include "filasofia/geometry/off_reader.h"

#include "filasofia/geometry/raw_surface.h"

// The format: Geomview manual, "OFF files". A vertex and a face are a line each; what stands behind the coordinates or
// the corners (normals, colours) is not used.
namespace filasofia::geometry {
namespace {

void checkOffHeader(NumberSource& in)
{
    const std::string_view word = in.word();
    const std::string header = lowered(word);
    // Texture coordinates, colours and normals of the vertices may be announced. Other dimensions are not read.
    if (word.ends_with("nOFF") || !header.ends_with("off") || header.find_first_not_of("stcn") != header.size() - 3)
        in.failHere("an OFF file must begin with OFF, COFF, NOFF, STOFF or several of these, got ", quoted(word));
    if (lowered(in.wordOnThisLine()) == "binary") in.failHere("an OFF file must be text, got BINARY");
}

void passLine(NumberSource& in)
{
    while (!in.wordOnThisLine().empty()) {
    }
}

} // namespace

TriangleMesh parseOff(std::string_view bytes, std::string_view name)
{
    NumberSource in(bytes, name);
    in.takeComments();
    checkOffHeader(in);
    const std::size_t points = in.count("the number of vertices", 3, 1, 4);
    const std::size_t faces = in.count("the number of faces", 2, 1, 4);
    passLine(in); // the number of edges
    RawSurface raw{.keepsUnused = true};
    raw.points.reserve(points);
    for (std::size_t i = 0; i < points; ++i) {
        const double x = in.real("a vertex's x"), y = in.real("a vertex's y");
        raw.points.push_back({x, y, in.real("a vertex's z")});
        passLine(in);
    }
    std::vector<std::int64_t> corners;
    for (std::size_t i = 0; i < faces; ++i) {
        corners.resize(in.count("a face's number of corners", 1, 1, 4));
        const std::size_t place = in.place();
        for (std::int64_t& corner : corners) corner = in.integer("a face's corner");
        raw.add(corners, static_cast<std::int64_t>(i), place);
        passLine(in);
    }
    return resolve(raw, in, name);
}

} // namespace filasofia::geometry
