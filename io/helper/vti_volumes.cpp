// Reads and writes VTI with VTK's XML reader and writer.
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkOutputWindow.h>
#include <vtkPointData.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkUnsignedCharArray.h>
#include <vtkXMLImageDataReader.h>
#include <vtkXMLImageDataWriter.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "io/helper/headers.hpp"
#include "io/helper/library_words.hpp"
#include "io/helper/readers.hpp"
#include "io/helper/vti_arrays.hpp"
#include "io/helper/vtk_errors.hpp"
#include "io/helper/vtk_type.hpp"

namespace palpate::io {
namespace {

void check_errors(const ErrorKeeper& errors) {
    if (errors.first().empty()) return;
    throw Failure("is damaged or no VTI file (" + errors.first() +
                  "); copy it again or export it again");
}

/// The start tag of the image among the file's first bytes; empty if it is not there.
std::string image_tag(const std::string& head) {
    const auto at = head.find("<ImageData");
    return at == std::string::npos ? "" : head.substr(at + 1, head.find('>', at) - at - 1);
}

/// VTK inverts the matrix that these make. Whether there is a spacing.
bool check_placement(const std::string& tag) {
    const auto spacings = vti_numbers(tag, "Spacing", 3);
    for (const double spacing : spacings) {
        if (spacing != 0) check_spacing(spacing, "Spacing");  // 0: of one sample, replaced later
    }
    for (const double coordinate : vti_numbers(tag, "Origin", 3))
        check_coordinate(coordinate, "Origin");
    for (const double cosine : vti_numbers(tag, "Direction", 9)) {
        if (std::abs(cosine) <= 1.01) continue;
        throw Failure("its Direction has the number " + text_of(cosine) +
                      ", which is no direction cosine; correct it");
    }
    return !spacings.empty();
}

/// Checks the first and the last tag, because VTK accepts raw data that are cut off. Whether there
/// is a spacing.
bool check_ends(const Request& request) {
    std::ifstream in(request.path, std::ios::binary);
    std::string text(65536, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    const std::string tag = image_tag(text);
    if (text.find("<VTKFile") == std::string::npos || tag.empty()) {
        throw Failure("is not a VTI file (no VTKFile of type ImageData in it); check its name");
    }
    const bool has_spacing = check_placement(tag);
    const auto size = static_cast<std::streamoff>(std::filesystem::file_size(request.path));
    in.clear();
    in.seekg(std::max<std::streamoff>(0, size - 256));
    text.assign(std::istreambuf_iterator<char>(in), {});
    const std::string last = "</VTKFile>";
    const std::string end = trimmed(text);
    if (end.size() < last.size() || end.substr(end.size() - last.size()) != last) {
        throw Failure("it is cut off (no </VTKFile> at its end); copy or download it again");
    }
    return has_spacing;
}

/// VTK's reader, which leaves open what its pieces hold.
class PieceReader : public vtkXMLImageDataReader {
  public:
    static PieceReader* New() { VTK_STANDARD_NEW_BODY(PieceReader); }
    vtkTypeMacro(PieceReader, vtkXMLImageDataReader) PieceReader(const PieceReader&) = delete;
    PieceReader& operator=(const PieceReader&) = delete;

    /// Whether its pieces give every sample of `extent` a value. `cells`: samples lie between the
    /// extent's numbers, not at them.
    bool covers(const int extent[6], bool cells) const {
        const auto end = [cells](const int* e, int a) {
            return e[2 * a + 1] - (cells && e[2 * a + 1] > e[2 * a] ? 1 : 0);
        };
        std::size_t sizes[3];
        for (int a = 0; a < 3; ++a) {
            sizes[a] = static_cast<std::size_t>(end(extent, a) - extent[2 * a] + 1);
        }
        std::vector<bool> has(sizes[0] * sizes[1] * sizes[2]);
        for (int p = 0; p < NumberOfPieces; ++p) {
            const int* const piece = PieceExtents + 6 * p;
            const auto first = [&](int a) { return std::max(piece[2 * a], extent[2 * a]); };
            const auto last = [&](int a) { return std::min(end(piece, a), end(extent, a)); };
            for (int z = first(2); z <= last(2); ++z) {
                for (int y = first(1); y <= last(1); ++y) {
                    const std::size_t row = (static_cast<std::size_t>(z - extent[4]) * sizes[1] +
                                             static_cast<std::size_t>(y - extent[2])) *
                                            sizes[0];
                    for (int x = first(0); x <= last(0); ++x) {
                        has[row + static_cast<std::size_t>(x - extent[0])] = true;
                    }
                }
            }
        }
        return std::ranges::find(has, false) == has.end();
    }

  protected:
    PieceReader() = default;
};

Stored stored_of(vtkDataArray& array) {
    const int type = array.GetDataType();
    const std::string kind = type == VTK_FLOAT || type == VTK_DOUBLE ? "float"
                             : array.GetDataTypeMin() < 0            ? "int"
                                                                     : "uint";
    const auto stored = stored_named(kind + std::to_string(8 * array.GetDataTypeSize()));
    if (!stored) throw Failure("its sample type is not read; save it as Float32");
    return *stored;
}

/// Whether an array marks samples that do not count, in VTK's own use.
bool is_ghosts(vtkDataArray* array) {
    return array != nullptr && array->GetName() != nullptr &&
           std::string(array->GetName()).starts_with("vtkGhost");
}

/// The active scalars, else the first array with one value a sample, else one to be refused with
/// a reason.
vtkDataArray* choose_array(vtkDataSetAttributes* data, std::vector<std::string>& notes) {
    std::vector<vtkDataArray*> arrays{data->GetScalars()};
    for (int i = 0; i < data->GetNumberOfArrays(); ++i) arrays.push_back(data->GetArray(i));
    std::erase_if(arrays, [](vtkDataArray* one) { return one == nullptr || is_ghosts(one); });
    if (arrays.empty()) return nullptr;
    const auto found = std::ranges::find_if(
        arrays, [](vtkDataArray* one) { return one->GetNumberOfComponents() == 1; });
    vtkDataArray* const chosen = found == arrays.end() ? arrays.front() : *found;
    if (data->GetNumberOfArrays() > 1) {
        notes.push_back("it has " + std::to_string(data->GetNumberOfArrays()) + " arrays; '" +
                        (chosen->GetName() ? chosen->GetName() : "") + "' was taken");
    }
    return chosen;
}

Geometry geometry_of(vtkImageData& image, bool at_cells) {
    Geometry g;
    int extent[6];
    image.GetExtent(extent);
    const vtkMatrix3x3* const direction = image.GetDirectionMatrix();
    Vec3 first;
    for (int a = 0; a < 3; ++a) {
        const int samples = extent[2 * a + 1] - extent[2 * a] + 1;
        g.size[a] = at_cells ? std::max(1, samples - 1) : samples;
        g.spacing[a] = image.GetSpacing()[a];
        g.origin[a] = image.GetOrigin()[a];
        first[a] = extent[2 * a] + (at_cells && samples > 1 ? 0.5 : 0.0);
        for (int r = 0; r < 3; ++r) g.direction(r, a) = direction->GetElement(r, a);
    }
    g.oriented = false;  // VTK's space is nobody's
    // VTK's origin is where index 0 lies, which need not be the first sample.
    if (first != Vec3::Zero()) g.origin = physical_from_index(g, first);
    return g;
}

void check_size(vtkXMLImageDataReader& reader, const Request& request) {
    int extent[6] = {0, -1, 0, -1, 0, -1};  // VTK leaves it alone where the file has none
    reader.GetOutputInformation(0)->Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent);
    std::vector<std::int64_t> sizes;
    for (int a = 0; a < 3; ++a) {
        sizes.push_back(std::int64_t{extent[2 * a + 1]} - extent[2 * a] + 1);
    }
    const auto file_bytes = std::filesystem::file_size(request.path);
    const std::uint64_t samples = checked_bytes(sizes, 1, file_bytes, request);
    bound_memory(4 * file_bytes + 64 * samples);  // VTK reads all arrays
}

}  // namespace

Result read_vti(const Request& request) {
    const bool has_spacing = check_ends(request);
    check_vti_arrays(request.path);
    const vtkNew<ErrorKeeper> errors;
    vtkOutputWindow::SetInstance(errors);
    const vtkNew<PieceReader> reader;
    reader->SetFileName(request.path.c_str());
    reader->UpdateInformation();
    check_errors(*errors);
    check_size(*reader, request);
    reader->Update();
    check_errors(*errors);
    say_progress(0.7);

    Result result;
    result.format = "VTI";
    vtkImageData& image = *reader->GetOutput();
    vtkDataArray* array = choose_array(image.GetPointData(), result.notes);
    const bool at_cells = array == nullptr;
    if (at_cells) {
        array = choose_array(image.GetCellData(), result.notes);
        result.notes.emplace_back(
            "its samples belong to cells: they were put at the cells' centres");
    }
    if (array == nullptr) throw Failure("has no samples in it; export it again");
    if (array->GetNumberOfComponents() != 1) {
        throw Failure("it has " + std::to_string(array->GetNumberOfComponents()) +
                      " values a sample (colours or vectors); give a volume with one");
    }
    checked_time_step(request, 1);
    if (!reader->covers(image.GetExtent(), at_cells)) {
        throw Failure(
            "its pieces do not fill its WholeExtent; it is damaged or a part of it is missing: "
            "export it again");
    }
    result.geometry = geometry_of(image, at_cells);
    result.geometry.measured = has_spacing;
    if (!has_spacing) result.notes.emplace_back("it gives no spacing: 1 mm was taken");
    for (int a = 0; a < 3; ++a) {
        if (result.geometry.size[a] == 1 && !(result.geometry.spacing[a] > 0)) {
            result.geometry.spacing[a] = 1;
        }
    }
    const auto count = static_cast<std::size_t>(sample_count(result.geometry));
    if (static_cast<std::size_t>(array->GetNumberOfTuples()) != count) {
        throw Failure("it has " + std::to_string(array->GetNumberOfTuples()) +
                      " samples, its grid " + std::to_string(count) +
                      "; it is damaged: export it again");
    }
    const Stored stored = stored_of(*array);
    result.type = kept_as(stored);
    note_conversion(stored, {}, result.notes);
    const auto samples = shared_samples(count * size_of(result.type));
    convert(stored, static_cast<const std::byte*>(array->GetVoidPointer(0)), result.type,
            samples.data(), count);
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
