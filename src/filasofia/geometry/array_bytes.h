#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace filasofia::geometry {

/// The bytes of an array in a VTK XML file: as they are, or spelled in base64 (RFC 4648) with white space. Base64 may
/// end in '=' and begin anew, as writers do between the sizes and the data.
class ArrayBytes {
public:
    ArrayBytes(std::string_view text, bool base64) : text_(text), base64_(base64) {}

    /// An upper bound of the number of bytes that are left.
    [[nodiscard]] std::size_t most() const { return decoded_.size() + text_.size(); }
    /// The next bytes; fewer if there are no more. They are valid until the next call.
    std::string_view take(std::size_t count);

private:
    void decodeFour();

    std::string_view text_; ///< what is left of it
    bool base64_ = false;
    std::string decoded_; ///< bytes that are decoded and not taken yet
    std::string taken_;
};

} // namespace filasofia::geometry
