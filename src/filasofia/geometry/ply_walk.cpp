#include "filasofia/geometry/ply_walk.h"

#include "filasofia/geometry/number_source.h"

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

// The format: Turk 1994, The PLY polygon file format.
namespace filasofia::geometry {
namespace {

struct Property {
    std::size_t size = 0;      // bytes of one number
    std::size_t countSize = 0; // bytes of the count before a list; 0 if it is not a list
};

struct Element {
    std::string name;
    std::size_t count = 0;
    std::vector<Property> properties;
};

struct Header {
    bool binary = false, bigEndian = false;
    std::vector<Element> elements;
};

std::size_t sizeOfType(const NumberSource& in, std::string_view type, bool counts)
{
    struct Type {
        std::string_view name, alias;
        std::size_t size;
    };
    static constexpr Type kTypes[] = {{"char", "int8", 1},     {"uchar", "uint8", 1},   {"short", "int16", 2},
                                      {"ushort", "uint16", 2}, {"int", "int32", 4},     {"uint", "uint32", 4},
                                      {"float", "float32", 4}, {"double", "float64", 8}};
    for (const Type& known : kTypes)
        if ((type == known.name || type == known.alias) && !(counts && known.name.find_first_of("fd") == 0))
            return known.size;
    in.failHere(counts ? "a list's count must be of an integer type"
                       : "a property's type must be a PLY type such as float or int32");
}

Property readProperty(NumberSource& in)
{
    const std::string_view type = in.wordOnThisLine();
    Property property;
    if (type == "list") {
        property.countSize = sizeOfType(in, in.wordOnThisLine(), true);
        property.size = sizeOfType(in, in.wordOnThisLine(), false);
    } else {
        property.size = sizeOfType(in, type, false);
    }
    if (in.wordOnThisLine().empty()) in.failHere("a property must have a name");
    if (!in.wordOnThisLine().empty()) in.failHere("a line must end after a property's name");
    return property;
}

void readFormat(NumberSource& in, Header& header)
{
    const std::string_view format = in.wordOnThisLine();
    header.binary = format == "binary_little_endian" || format == "binary_big_endian";
    header.bigEndian = format == "binary_big_endian";
    if (!header.binary && format != "ascii")
        in.failHere("the format must be ascii, binary_little_endian or binary_big_endian");
}

Header readHeader(NumberSource& in)
{
    if (in.word() != "ply") in.failHere("a PLY file must begin with ply");
    Header header;
    for (std::string_view word = in.word(); word != "end_header"; word = in.word()) {
        if (word.empty()) in.failHere("the file ends before end_header");
        if (word == "format") {
            readFormat(in, header);
        } else if (word == "element") {
            Element& element = header.elements.emplace_back();
            element.name = in.wordOnThisLine().substr(0, 40);
            // An element takes at least one byte, as text or binary.
            element.count = in.count("the number of elements '" + element.name + "'", 1, 1, 4);
        } else if (word == "property") {
            if (header.elements.empty()) in.failHere("a property must come after its element");
            header.elements.back().properties.push_back(readProperty(in));
        }
        if (!in.skipPast("\n"))
            in.failHere("the file ends before end_header"); // skips comments and the rest of the line
    }
    return header;
}

std::size_t readRawCount(NumberSource& in, std::size_t size, bool bigEndian)
{
    std::size_t count = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const std::size_t byte = static_cast<unsigned char>(in.byte());
        count = bigEndian ? count << 8 | byte : count | byte << (8 * i);
    }
    return count;
}

void walkRaw(NumberSource& in, const Header& header)
{
    for (const Element& element : header.elements)
        for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i)
            for (const Property& property : element.properties) {
                const std::size_t numbers =
                    property.countSize > 0 ? readRawCount(in, property.countSize, header.bigEndian) : 1;
                in.skipBytes(numbers * property.size, element.name);
            }
}

// An element is a line: assimp counts lines, whatever their content.
void walkLine(NumberSource& in, const Element& element)
{
    bool first = true;
    const auto next = [&] {
        const std::string_view word = first ? in.word() : in.wordOnThisLine();
        if (word.empty()) in.failHere(first ? "the file" : "the line", " ends before all numbers of ", element.name);
        first = false;
        return word;
    };
    for (const Property& property : element.properties) {
        if (property.countSize == 0) {
            in.realIn(next(), element.name);
            continue;
        }
        const std::int64_t count = in.integerIn(next(), "the length of a list");
        in.boundCount(count, "the length of a list", 1, 1);
        for (std::int64_t i = 0; i < count; ++i) in.realIn(next(), element.name);
    }
    if (!first && !in.wordOnThisLine().empty()) in.failHere("the line has more numbers than ", element.name, " has");
}

void walkText(NumberSource& in, const Header& header)
{
    for (const Element& element : header.elements)
        for (std::size_t i = 0; i < element.count && !element.properties.empty(); ++i) walkLine(in, element);
}

} // namespace

void walkPly(std::string_view bytes, std::string_view name)
{
    NumberSource in(bytes, name);
    const Header header = readHeader(in);
    if (!header.binary) return walkText(in, header);
    if (!in.skipPast("\n")) in.failHere("the file ends after its header");
    in.becomeBinary(header.bigEndian != (std::endian::native == std::endian::big));
    walkRaw(in, header);
}

} // namespace filasofia::geometry
