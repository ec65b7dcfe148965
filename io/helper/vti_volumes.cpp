// Reads and writes VTI. VTK parses the XML, unpacks blocks and writes. The arrays are read here,
// because VTK's reader takes as many bytes as the type of an array takes, and ignores all others.
// Format: https://docs.vtk.org/en/latest/design_documents/VTKFileFormats.html.
#include <vtkDataArray.h>
#include <vtkDataCompressor.h>
#include <vtkImageData.h>
#include <vtkLZ4DataCompressor.h>
#include <vtkLZMADataCompressor.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLDataParser.h>
#include <vtkXMLImageDataWriter.h>
#include <vtkZLibDataCompressor.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <sstream>

#include "io/byte_order.hpp"
#include "io/helper/headers.hpp"
#include "io/helper/readers.hpp"
#include "io/helper/vtk_errors.hpp"
#include "io/helper/vtk_type.hpp"
#include "io/system/number.hpp"

namespace palpate::io {
namespace {

/// Empty if there is no such attribute.
std::string attribute(vtkXMLDataElement& element, const char* name) {
    const char* const value = element.GetAttribute(name);
    return value != nullptr ? value : "";
}

/// As many numbers as belong there; none if there is no such attribute.
std::vector<double> numbers_of(vtkXMLDataElement& element, const char* name, std::size_t count) {
    const auto numbers = numbers_in(attribute(element, name), name);
    if (numbers.empty() || numbers.size() == count) return numbers;
    throw Failure("its " + std::string(name) + " has " + std::to_string(numbers.size()) +
                  " numbers where " + std::to_string(count) + " belong; correct it");
}

/// The elements of a name in another one.
std::vector<vtkXMLDataElement*> children_of(vtkXMLDataElement* parent, const std::string& name) {
    std::vector<vtkXMLDataElement*> found;
    for (int i = 0; parent != nullptr && i < parent->GetNumberOfNestedElements(); ++i) {
        vtkXMLDataElement* const one = parent->GetNestedElement(i);
        if (one->GetName() == name) found.push_back(one);
    }
    return found;
}

/// A parser stops where raw data begin, which may be cut off.
void check_end(const std::filesystem::path& path) {
    std::ifstream in(path, std::ios::binary);
    const auto size = static_cast<std::streamoff>(std::filesystem::file_size(path));
    in.seekg(std::max<std::streamoff>(0, size - 256));
    const std::string text(std::istreambuf_iterator<char>(in), {});
    if (trimmed(text).ends_with("</VTKFile>")) return;
    throw Failure("it is cut off (no </VTKFile> at its end); copy or download it again");
}

[[noreturn]] void refuse(vtkXMLDataElement& array, const std::string& what) {
    throw Failure("its array '" + attribute(array, "Name").substr(0, 40) + "' " + what);
}

constexpr const char* moved_bytes =
    "its arrays do not end where its raw data do: bytes were lost or added, perhaps by a transfer "
    "as text; copy or export it again";
constexpr const char* wrong_end =
    "does not end where its length says; correct the header_type of the file, or export it again";

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

/// Texts in base64, one behind the other, up to what is none.
std::string decoded(std::string_view text) {
    static constexpr std::string_view digits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string data;
    unsigned bits = 0, value = 0;
    for (const char c : text) {
        const std::size_t digit = digits.find(c);
        if (c == '=') bits = 0;  // the end of one of them
        if (c == '=' || is_blank(c)) continue;
        if (digit == digits.npos) break;
        value = value << 6 | static_cast<unsigned>(digit);
        bits += 6;
        if (bits < 8) continue;
        bits -= 8;
        data += static_cast<char>(value >> bits);
    }
    return data;
}

/// The elements of a file, and the samples of its arrays.
class VtiFile {
  public:
    explicit VtiFile(const std::filesystem::path& path) : in_(path, std::ios::binary) {
        vtkOutputWindow::SetInstance(errors_);
        parser_->SetStream(&in_);
        const bool is_parsed = parser_->Parse() != 0;
        if (!is_parsed || !errors_->first().empty()) {
            throw Failure("is damaged or no VTI file (" + errors_->first() +
                          "); copy it again or export it again");
        }
        vtkXMLDataElement* const root = parser_->GetRootElement();
        const auto images = children_of(root, "ImageData");
        if (images.empty()) throw Failure("is not a VTI file (it has no ImageData)");
        image_ = images[0];
        width_ = attribute(*root, "header_type") == "UInt64" ? 8 : 4;
        swapped_ = (attribute(*root, "byte_order") == "BigEndian") !=
                   (std::endian::native == std::endian::big);
        use_compressor(attribute(*root, "compressor"));
        for (vtkXMLDataElement* const one : children_of(root, "AppendedData")) {
            is_raw_ = attribute(*one, "encoding") == "raw";
        }
        find_offsets(root);
    }

    vtkXMLDataElement& image() const { return *image_; }

    /// As they are stored, in the machine's byte order. `count`: numbers that the array should
    /// have.
    std::vector<std::byte> samples(vtkXMLDataElement& array, Stored stored, std::uint64_t count) {
        std::string text;
        in_.clear();
        const auto offset = number_from<std::uint64_t>(attribute(array, "offset"));
        if (offset) {
            in_.seekg(parser_->GetAppendedDataPosition() + static_cast<std::streamoff>(*offset));
            if (!is_raw_) text = appended_text(*offset);
        } else {
            in_.seekg(static_cast<std::streamoff>(array.GetXMLByteIndex()));
            in_.ignore(std::numeric_limits<std::streamsize>::max(), '>');
            std::getline(in_, text, '<');
            if (attribute(array, "format") != "binary") return numbers_in_text(text, stored, count);
        }
        std::vector<std::byte> samples(count * size_of(stored));
        if (offset && is_raw_) {
            unpack(in_, array, samples);
        } else {
            std::istringstream packed(decoded(text));
            unpack(packed, array, samples);
            // Otherwise its head has numbers of another width, and a part of it lies in the data.
            if (packed.peek() != std::istream::traits_type::eof()) refuse(array, wrong_end);
        }
        if (swapped_) swap_bytes(samples, size_of(stored));
        return samples;
    }

    /// Raw arrays end where the last one does. Otherwise bytes were lost or added, by a transfer as
    /// text for example, and others would be taken for samples.
    void check_raw_end() {
        if (!is_raw_ || compressor_ || offsets_.empty()) return;
        in_.clear();
        in_.seekg(parser_->GetAppendedDataPosition() +
                  static_cast<std::streamoff>(*offsets_.rbegin()));
        const std::uint64_t bytes = next_number(in_), back = std::min<std::uint64_t>(bytes, 64);
        in_.seekg(static_cast<std::streamoff>(bytes - back), std::ios::cur);
        std::string text(static_cast<std::size_t>(back) + 256, ' ');
        in_.read(text.data(), std::ssize(text));
        const std::string rest = text.substr(back);
        // Writers end the line before the tag. That end lies in the array where bytes were lost.
        const auto before = text.substr(0, back).find_last_not_of(" \t");
        const bool is_moved =
            rest[0] != '\n' && rest[0] != '\r' && before != text.npos && text[before] == '\n';
        if (!is_moved && trimmed(rest).starts_with("</AppendedData")) return;
        throw Failure(moved_bytes);
    }

  private:
    void use_compressor(const std::string& name) {
        if (name == "vtkZLibDataCompressor") compressor_ = vtkNew<vtkZLibDataCompressor>();
        if (name == "vtkLZ4DataCompressor") compressor_ = vtkNew<vtkLZ4DataCompressor>();
        if (name == "vtkLZMADataCompressor") compressor_ = vtkNew<vtkLZMADataCompressor>();
        if (name.empty() || compressor_) return;
        throw Failure("its compressor '" + name.substr(0, 40) +
                      "' is not read; save it with vtkZLibDataCompressor");
    }

    void find_offsets(vtkXMLDataElement* parent) {
        for (int i = 0; i < parent->GetNumberOfNestedElements(); ++i) {
            vtkXMLDataElement* const one = parent->GetNestedElement(i);
            const auto offset = number_from<std::uint64_t>(attribute(*one, "offset"));
            if (offset) offsets_.insert(*offset);
            find_offsets(one);
        }
    }

    /// Up to the next array, or to the end of the last one.
    std::string appended_text(std::uint64_t offset) {
        std::string text;
        const auto next = offsets_.upper_bound(offset);
        if (next == offsets_.end()) {
            std::getline(in_, text, '<');
        } else {
            text.resize(*next - offset);
            in_.read(text.data(), std::ssize(text));
            text.resize(static_cast<std::size_t>(in_.gcount()));
        }
        return text;
    }

    /// Refuses other numbers than `count`. What is no number ends them.
    static std::vector<std::byte> numbers_in_text(const std::string& text, Stored stored,
                                                  std::uint64_t count) {
        std::vector<std::byte> samples;
        std::uint64_t found = 0;
        const char *at = text.data(), *const end = at + text.size();
        for (double number = 0;; ++found) {
            at = std::find_if_not(at, end, is_blank);
            const auto [next, error] = read_number(at, end, number);
            if (error != std::errc{}) break;
            append_sample(number, stored, samples);
            at = next;
        }
        if (found == count) return samples;
        throw Failure(std::string("an array has ") + (found > count ? "more" : "fewer") +
                      " numbers than its piece has samples; it is damaged: export it again");
    }

    std::uint64_t next_number(std::istream& in) const {
        std::array<std::byte, 8> bytes{};
        in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(width_));
        return width_ == 8 ? number_in<std::uint64_t>(bytes, swapped_)
                           : number_in<std::uint32_t>(bytes, swapped_);
    }

    /// Compares the bytes that an array has with those that its samples take.
    static void check_bytes(vtkXMLDataElement& array, double has, std::size_t needed) {
        if (has == static_cast<double>(needed)) return;
        refuse(array, "has " + text_of(has) + " bytes, but its samples take " +
                          text_of(static_cast<double>(needed)) +
                          "; correct the type of its DataArray, or the header_type of the file");
    }

    /// The length of the data stands before them.
    void unpack(std::istream& in, vtkXMLDataElement& array, std::span<std::byte> to) const {
        if (compressor_) return unpack_blocks(in, array, to);
        check_bytes(array, static_cast<double>(next_number(in)), to.size());
        in.read(reinterpret_cast<char*>(to.data()), std::ssize(to));
        if (!in) is_raw_ ? throw Failure(moved_bytes) : refuse(array, wrong_end);
    }

    /// Before them are how many there are, the bytes of a block, those of the last one, if it is
    /// shorter, and how many bytes each of them takes.
    void unpack_blocks(std::istream& in, vtkXMLDataElement& array, std::span<std::byte> to) const {
        const std::uint64_t blocks = next_number(in), each = next_number(in),
                            last = next_number(in);
        const double whole = static_cast<double>(blocks) - (last > 0 ? 1 : 0);
        check_bytes(array, whole * static_cast<double>(each) + static_cast<double>(last),
                    to.size());
        if (blocks > to.size()) refuse(array, wrong_end);
        std::vector<std::uint64_t> packed_sizes(blocks);
        for (std::uint64_t& size : packed_sizes) size = next_number(in);
        std::vector<unsigned char> packed;
        for (const std::uint64_t size : packed_sizes) {
            const auto part = to.first(std::min<std::uint64_t>(each, to.size()));
            packed.resize(std::min(size, 2 * part.size() + 65536));
            in.read(reinterpret_cast<char*>(packed.data()), std::ssize(packed));
            auto* const out = reinterpret_cast<unsigned char*>(part.data());
            if (!in || packed.size() != size || part.empty() ||
                compressor_->Uncompress(packed.data(), size, out, part.size()) != part.size()) {
                refuse(array, "has a block that cannot be unpacked; copy or export it again");
            }
            to = to.subspan(part.size());
        }
        if (!to.empty()) refuse(array, wrong_end);
    }

    std::ifstream in_;
    vtkNew<ErrorKeeper> errors_;
    vtkNew<vtkXMLDataParser> parser_;
    vtkXMLDataElement* image_ = nullptr;
    vtkSmartPointer<vtkDataCompressor> compressor_;
    std::size_t width_ = 4;  ///< [bytes] of the numbers before the data of an array
    bool swapped_ = false, is_raw_ = false;
    std::set<std::uint64_t> offsets_;  ///< of all arrays behind the elements
};

/// Where samples lie. Those of cells lie between the numbers of VTK's extents, not at them.
struct VtiBox {
    std::array<int, 3> first{}, size{};

    VtiBox(vtkXMLDataElement& element, const char* name, bool in_cells) {
        constexpr double most = 1 << 29;
        const auto numbers = numbers_of(element, name, 6);
        const auto is_wrong = [](double n) { return !(std::abs(n) <= most) || n != std::floor(n); };
        if (numbers.empty() || std::ranges::any_of(numbers, is_wrong)) {
            throw Failure("its " + std::string(name) + " is not possible; correct it");
        }
        for (std::size_t a = 0; a < 3; ++a) {
            first[a] = static_cast<int>(numbers[2 * a]);
            const int steps = static_cast<int>(numbers[2 * a + 1]) - first[a];
            size[a] = in_cells && steps > 0 ? steps : steps + 1;
        }
    }
    int end(std::size_t a) const { return first[a] + size[a]; }
    /// Bytes of so many samples. Throws Failure for sizes that are not possible.
    std::uint64_t bytes(std::size_t each, const Request& request) const {
        const std::int64_t sizes[] = {size[0], size[1], size[2]};
        return checked_bytes(sizes, each, std::filesystem::file_size(request.path), request);
    }
};

/// Whether an array marks samples that do not count, in VTK's own use.
bool is_ghosts(vtkXMLDataElement* array) {
    return attribute(*array, "Name").starts_with("vtkGhost");
}

double components_of(vtkXMLDataElement& array) {
    const auto told = numbers_of(array, "NumberOfComponents", 1);
    return told.empty() ? 1 : told[0];
}

Stored stored_of(vtkXMLDataElement& array) {
    const auto stored = stored_named(lower(attribute(array, "type")));
    if (stored && *stored != Stored::float16) return *stored;
    throw Failure("its sample type is not read; save it as Float32");
}

/// The active scalars, else the first array with one value a sample, else one to be refused with
/// a reason. Null if there is none.
vtkXMLDataElement* choose_array(vtkXMLDataElement* data, std::vector<std::string>& notes) {
    std::vector<vtkXMLDataElement*> arrays = children_of(data, "DataArray");
    const std::size_t all = arrays.size();
    for (vtkXMLDataElement* const one : arrays) {
        if (!attribute(*one, "Name").empty()) continue;
        throw Failure("has an array without a name; give its DataArray a Name");
    }
    std::erase_if(arrays, is_ghosts);
    if (arrays.empty()) return nullptr;
    std::stable_partition(arrays.begin(), arrays.end(), [&](vtkXMLDataElement* one) {
        return attribute(*one, "Name") == attribute(*data, "Scalars");
    });
    const auto found = std::ranges::find_if(
        arrays, [](vtkXMLDataElement* one) { return components_of(*one) == 1; });
    vtkXMLDataElement* const chosen = found == arrays.end() ? arrays.front() : *found;
    if (all > 1) {
        notes.push_back("it has " + std::to_string(all) + " arrays; '" +
                        attribute(*chosen, "Name") + "' was taken");
    }
    return chosen;
}

Geometry geometry_of(vtkXMLDataElement& image, bool at_cells) {
    const VtiBox box(image, "WholeExtent", at_cells), points(image, "WholeExtent", false);
    const auto spacings = numbers_of(image, "Spacing", 3), origin = numbers_of(image, "Origin", 3),
               direction = numbers_of(image, "Direction", 9);
    Geometry g;
    Vec3 first;
    for (int a = 0; a < 3; ++a) {
        const auto i = static_cast<std::size_t>(a);
        g.size[a] = box.size[i];
        // A spacing of 0 is that of one sample.
        if (!spacings.empty() && (spacings[i] != 0 || g.size[a] > 1)) g.spacing[a] = spacings[i];
        if (!origin.empty()) g.origin[a] = origin[i];
        check_spacing(g.spacing[a], "Spacing");
        check_coordinate(g.origin[a], "Origin");
        first[a] = box.first[i] + (points.size[i] > box.size[i] ? 0.5 : 0.0);
    }
    for (std::size_t i = 0; i < direction.size(); ++i) {
        if (!(std::abs(direction[i]) <= 1.01)) {
            throw Failure("its Direction has the number " + text_of(direction[i]) +
                          ", which is no direction cosine; correct it");
        }
        g.direction(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3)) =
            direction[i];
    }
    g.oriented = false;  // VTK's space is nobody's
    g.measured = !spacings.empty();
    // VTK's origin is where index 0 lies, which need not be the first sample.
    if (first != Vec3::Zero()) g.origin = physical_from_index(g, first);
    return g;
}

/// Converts the samples of a piece that lie in the image, whose others stay as they are. `has` says
/// of each sample whether it has come.
void put_piece(const std::vector<std::byte>& from, Stored stored, const VtiBox& piece,
               const VtiBox& whole, SampleType type, std::span<std::byte> to,
               std::vector<bool>& has) {
    const auto first = [&](std::size_t a) { return std::max(piece.first[a], whole.first[a]); };
    const auto end = [&](std::size_t a) { return std::min(piece.end(a), whole.end(a)); };
    const auto place_in = [&](const VtiBox& box, int y, int z) {
        const auto row = std::int64_t{z - box.first[2]} * box.size[1] + (y - box.first[1]);
        return static_cast<std::size_t>(row * box.size[0] + (first(0) - box.first[0]));
    };
    if (end(0) <= first(0)) return;
    const auto count = static_cast<std::size_t>(end(0) - first(0));
    for (int z = first(2); z < end(2); ++z) {
        for (int y = first(1); y < end(1); ++y) {
            const std::size_t at = place_in(whole, y, z);
            convert(stored, from.data() + place_in(piece, y, z) * size_of(stored), type,
                    to.data() + at * size_of(type), count);
            std::fill_n(has.begin() + static_cast<std::ptrdiff_t>(at), count, true);
        }
    }
}

}  // namespace

Result read_vti(const Request& request) {
    check_end(request.path);
    VtiFile file(request.path);
    Result result;
    result.format = "VTI";
    const std::uint64_t points = VtiBox(file.image(), "WholeExtent", false).bytes(1, request);
    bound_memory(4 * std::filesystem::file_size(request.path) + 64 * points);
    const auto pieces = children_of(&file.image(), "Piece");
    const auto data_of = [](vtkXMLDataElement* piece, const char* name) {
        const auto found = children_of(piece, name);
        return found.empty() ? nullptr : found.front();
    };
    if (pieces.empty()) throw Failure("has no samples in it; export it again");
    const char* section = "PointData";
    vtkXMLDataElement* chosen = choose_array(data_of(pieces[0], section), result.notes);
    const bool at_cells = chosen == nullptr;
    if (at_cells) {
        section = "CellData";
        chosen = choose_array(data_of(pieces[0], section), result.notes);
        result.notes.emplace_back(
            "its samples belong to cells: they were put at the cells' centres");
    }
    if (chosen == nullptr) throw Failure("has no samples in it; export it again");
    if (components_of(*chosen) != 1) {
        throw Failure("it has " + text_of(components_of(*chosen)) +
                      " values a sample (colours or vectors); give a volume with one");
    }
    checked_time_step(request, 1);
    result.geometry = geometry_of(file.image(), at_cells);
    if (!result.geometry.measured) result.notes.emplace_back("it gives no spacing: 1 mm was taken");
    const Stored stored = stored_of(*chosen);
    result.type = kept_as(stored);
    note_conversion(stored, {}, result.notes);
    const VtiBox whole(file.image(), "WholeExtent", at_cells);
    const auto samples = shared_samples(whole.bytes(size_of(result.type), request));
    std::vector<bool> has(samples.size() / size_of(result.type));
    for (vtkXMLDataElement* const piece : pieces) {
        const VtiBox box(*piece, "Extent", at_cells);
        if (std::ranges::min(box.size) < 1) continue;
        for (vtkXMLDataElement* const array : children_of(data_of(piece, section), "DataArray")) {
            if (attribute(*array, "Name") != attribute(*chosen, "Name")) continue;
            if (stored_of(*array) != stored || components_of(*array) != 1) {
                throw Failure("the arrays of its pieces have different types; export it again");
            }
            const std::uint64_t count = box.bytes(size_of(stored), request) / size_of(stored);
            put_piece(file.samples(*array, stored, count), stored, box, whole, result.type, samples,
                      has);
            break;  // others of this name are of later times
        }
    }
    if (std::ranges::find(has, false) != has.end()) {
        throw Failure(
            "its pieces do not fill its WholeExtent; it is damaged or a part of it is missing: "
            "export it again");
    }
    file.check_raw_end();
    finish(result, request, samples);
    return result;
}

void write_vti(const std::filesystem::path& path, const WrittenVolume& volume) {
    const Geometry& geometry = volume.geometry;
    const vtkNew<ErrorKeeper> errors;
    vtkOutputWindow::SetInstance(errors);
    const vtkNew<vtkImageData> image;
    image->SetDimensions(geometry.size[0], geometry.size[1], geometry.size[2]);
    image->SetSpacing(geometry.spacing[0], geometry.spacing[1], geometry.spacing[2]);
    image->SetOrigin(geometry.origin[0], geometry.origin[1], geometry.origin[2]);
    for (int r = 0; r < 3; ++r) {
        for (int a = 0; a < 3; ++a) {
            image->GetDirectionMatrix()->SetElement(r, a, geometry.direction(r, a));
        }
    }
    const auto array =
        vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(vtk_type(volume.type)));
    array->SetName("density");
    // The writer only reads; VTK has no interface for constant memory. 1: it is not VTK's to free.
    array->SetVoidArray(const_cast<void*>(volume.samples), sample_count(geometry), 1);
    image->GetPointData()->SetScalars(array);
    const vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetFileName(path.c_str());
    writer->SetInputData(image);
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetHeaderTypeToUInt64();
    if (!volume.compress) writer->SetCompressorTypeToNone();
    if (writer->Write() == 0 || !errors->first().empty()) throw Failure(not_written_whole);
}

}  // namespace palpate::io
