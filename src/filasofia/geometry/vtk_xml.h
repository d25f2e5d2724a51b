#pragma once

#include "filasofia/geometry/array_bytes.h"
#include "filasofia/geometry/number_source.h"

#include <pugixml.hpp>
#include <vector>

namespace filasofia::geometry {

/// A VTK XML file: its elements, and the numbers of its arrays (text, base64 or appended, plain or deflated). Every
/// failure is an Error that names the file and the line.
class VtkXml {
public:
    /// Parses the elements. `bytes` and `name` must outlive this.
    VtkXml(std::string_view bytes, std::string_view name);

    /// For Errors at a line.
    [[nodiscard]] const NumberSource& file() const { return file_; }
    [[nodiscard]] std::string_view name() const { return name_; }
    /// What the file holds, such as UnstructuredGrid.
    [[nodiscard]] std::string_view type() const;
    /// The one piece of it.
    [[nodiscard]] pugi::xml_node piece() const;
    /// The line on which an element or a text begins.
    [[nodiscard]] std::size_t lineOf(const pugi::xml_node& node) const { return lineAt(node.offset_debug()); }
    template <class... Parts> [[noreturn]] void failAt(const pugi::xml_node& node, const Parts&... parts) const
    {
        file_.failAt(lineOf(node), parts...);
    }
    [[nodiscard]] pugi::xml_node child(const pugi::xml_node& parent, const char* name) const;
    [[nodiscard]] pugi::xml_node arrayOf(const pugi::xml_node& parent, const char* name) const;
    /// A number of things, >= 1, that an attribute announces.
    [[nodiscard]] std::int64_t countOf(const pugi::xml_node& piece, const char* name) const;

    /// The numbers of an array. Floating-point numbers cannot become whole ones. `loose`: a word that is none is NaN.
    [[nodiscard]] std::vector<double> realsOf(const pugi::xml_node& array, bool loose = false) const
    {
        return numbersOf<double>(array, loose);
    }
    [[nodiscard]] std::vector<std::int64_t> integersOf(const pugi::xml_node& array) const
    {
        return numbersOf<std::int64_t>(array, false);
    }

private:
    [[nodiscard]] std::size_t lineAt(std::ptrdiff_t offset) const;
    [[nodiscard]] NumberSource attributeOf(const pugi::xml_node& node, const char* name) const;
    template <class Number> std::vector<Number> numbersOf(const pugi::xml_node& array, bool loose) const;
    template <class Number> std::vector<Number> textOf(const pugi::xml_node& array, bool loose) const;
    template <class Raw, class Number> std::vector<Number> rawOf(const pugi::xml_node& array) const;
    [[nodiscard]] std::string bytesOf(const pugi::xml_node& array) const;
    [[nodiscard]] std::string inflated(ArrayBytes& from, const pugi::xml_node& array) const;
    [[nodiscard]] std::uint64_t sizeIn(ArrayBytes& from, const pugi::xml_node& array) const;
    template <class Raw> [[nodiscard]] Raw rawAt(const char* at) const;

    NumberSource file_; ///< for errors; everything is read from the document
    std::string_view bytes_, name_;
    std::string_view appended_; ///< from behind the '_'
    pugi::xml_document document_;
    bool swapped_ = false, appendedBase64_ = false;
    std::string_view compressor_; ///< empty: none
    std::size_t sizeBytes_ = 4;   ///< each of the sizes before an array's data
};

} // namespace filasofia::geometry
