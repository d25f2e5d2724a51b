#pragma once

#include "filasofia/core/error.h"

#include <cstdint>
#include <string_view>

namespace filasofia::geometry {

/// Walks through the bytes of a mesh file: words and numbers as text, or raw numbers of either byte order. Every
/// failure is an Error that names the file and where in it: the line as long as the file is text, else the byte.
class NumberSource {
public:
    NumberSource(std::string_view bytes, std::string_view name) : bytes_(bytes), name_(name) {}

    /// From here on numbers are raw; `swapped` where their byte order is not this machine's.
    void becomeBinary(bool swapped) { binary_ = true, swapped_ = swapped; }
    /// From here on '#' begins a comment that runs to the end of the line.
    void takeComments() { comments_ = true; }

    [[nodiscard]] bool isBinary() const { return binary_; }
    [[nodiscard]] std::size_t remaining() const { return bytes_.size() - at_; }
    /// The line or byte of what was read last, for failAt().
    [[nodiscard]] std::size_t place() const { return binary_ ? lastAt_ : lastLine_; }

    /// The next word up to white space, as text also in a binary file; empty at the end.
    std::string_view word();
    /// The next word if it stands on the line of the last one, else empty, and nothing is taken.
    std::string_view wordOnThisLine();
    /// Takes one byte. The end of the line before raw data.
    char byte();
    /// Goes on behind so many bytes that hold `what`.
    void skipBytes(std::size_t count, std::string_view what);
    /// Goes on behind `text`; false, and stays, where it does not occur any more.
    bool skipPast(std::string_view text);

    /// A whole number: as text, or as a raw one of 4 (int) or 8 (size_t) bytes. `what` names it in an Error.
    std::int64_t integer(std::string_view what, int rawSize = 4);
    /// A finite number: as text, or as a raw double.
    double real(std::string_view what);
    /// How many things follow, where each takes at least `numbers` numbers and `rawBytes` bytes: no more than the rest
    /// of the file can hold, whatever it announces.
    std::size_t count(std::string_view what, std::size_t numbers, std::size_t rawBytes, int rawSize);
    /// Holds a number of things against the same bound.
    void boundCount(std::int64_t count, std::string_view what, std::size_t numbers, std::size_t rawBytes) const;

    /// The number that a word is, whole or finite.
    std::int64_t integerIn(std::string_view word, std::string_view what) const;
    double realIn(std::string_view word, std::string_view what) const;

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
