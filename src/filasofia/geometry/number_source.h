#pragma once

#include "filasofia/core/error.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace filasofia::geometry {

/// The word with A to Z in lower case, whatever the locale.
std::string lowered(std::string_view word);

/// A word as an error shows it: in quotes, short, and printable whatever the file holds.
std::string quoted(std::string_view word);

/// Reads the bytes of a mesh file: words and numbers as text, or raw numbers of either byte order. Every failure is an
/// Error that names the file and the position: the line while the file is text, otherwise the byte.
class NumberSource {
public:
    /// `line`: of the file, in which the bytes begin.
    NumberSource(std::string_view bytes, std::string_view name, std::size_t line = 1)
        : bytes_(bytes), name_(name), line_(line), lastLine_(line)
    {
    }

    /// From here on numbers are binary; `swapped` if their byte order is not this machine's.
    void becomeBinary(bool swapped) { binary_ = true, swapped_ = swapped; }
    /// From here on '#' begins a comment that ends with the line.
    void takeComments() { comments_ = true; }

    [[nodiscard]] bool isBinary() const { return binary_; }
    [[nodiscard]] std::size_t remaining() const { return bytes_.size() - at_; }
    /// The line or byte of the last item read, for failAt().
    [[nodiscard]] std::size_t place() const { return binary_ ? lastAt_ : lastLine_; }

    /// The next word up to white space, even in a binary file; empty at the end of the file.
    std::string_view word();
    /// The next word if it stands on the same line as the last one; otherwise empty, and nothing is consumed.
    std::string_view wordOnThisLine();
    /// The next text between quotation marks; `what` names it in an Error.
    std::string_view textInQuotes(std::string_view what);
    /// Takes one byte, such as the end of the line before binary data.
    char byte();
    /// Skips this many bytes, which hold `what`.
    void skipBytes(std::size_t count, std::string_view what);
    /// Takes the rest of the line.
    std::string_view restOfLine();
    /// Skips to behind the next `text`; false, without moving, if there is none.
    bool skipPast(std::string_view text);

    /// A whole number: text, or 1, 2, 4 or 8 binary bytes with a sign. `what` names it in an Error.
    std::int64_t integer(std::string_view what, int rawSize = 4);
    /// A finite number: text, or 4 (float) or 8 (double) binary bytes.
    double real(std::string_view what, int rawSize = 8);
    /// The same, but anything that is no finite number becomes NaN.
    double anyReal(std::string_view what, int rawSize = 8);
    /// The number of items that follow, each of at least `numbers` numbers (text) or `rawBytes` bytes (binary): never
    /// more than the rest of the file can hold, whatever the file announces.
    std::size_t count(std::string_view what, std::size_t numbers, std::size_t rawBytes, int rawSize);
    /// Checks a number of items against the same bound.
    void boundCount(std::int64_t count, std::string_view what, std::size_t numbers, std::size_t rawBytes) const;

    /// The number that a word spells, whole or finite.
    std::int64_t integerIn(std::string_view word, std::string_view what) const;
    double realIn(std::string_view word, std::string_view what) const;
    double anyRealIn(std::string_view word) const; ///< NaN if it spells no finite number

    template <class... Parts> [[noreturn]] void failHere(const Parts&... parts) const { failAt(place(), parts...); }
    template <class... Parts> [[noreturn]] void failAt(std::size_t where, const Parts&... parts) const
    {
        if (binary_) fail(name_, ": byte ", where, ": ", parts...);
        fail(name_, ":", where, ": ", parts...);
    }

private:
    void skipSpace();
    std::string_view takeWord();
    template <class Raw> Raw raw(std::string_view what);

    std::string_view bytes_, name_;
    std::size_t at_ = 0, line_ = 1;
    std::size_t lastAt_ = 0, lastLine_ = 1;
    bool binary_ = false, swapped_ = false, comments_ = false;
};

} // namespace filasofia::geometry
