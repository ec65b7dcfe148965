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
#include "io/helper/vtk_errors.hpp"
#include "io/helper/vtk_type.hpp"

namespace palpate::io {
namespace {

void check_errors(const ErrorKeeper& errors) {
    if (errors.first().empty()) return;
    throw Failure("is damaged or no VTI file (" + errors.first() +
                  "); copy it again or export it again");
}

/// The numbers of an attribute in the file's first bytes; none if it is not there.
std::vector<double> attribute(const std::string& head, const std::string& name) {
    const auto at = head.find(" " + name + "=");
    if (at == std::string::npos || at + name.size() + 2 >= head.size()) return {};
    const auto begin = at + name.size() + 3;
    const auto end = head.find(head[begin - 1], begin);
    if (end == std::string::npos) return {};
    return numbers_in(head.substr(begin, end - begin), name);
}

/// VTK inverts the matrix that these make.
void check_placement(const std::string& head) {
    for (const double spacing : attribute(head, "Spacing")) {
        if (spacing != 0) check_spacing(spacing, "Spacing");  // 0: of one sample, replaced later
    }
    for (const double coordinate : attribute(head, "Origin"))
        check_coordinate(coordinate, "Origin");
    for (const double cosine : attribute(head, "Direction")) {
        if (std::abs(cosine) <= 1.01) continue;
        throw Failure("its Direction has the number " + text_of(cosine) +
                      ", which is no direction cosine; correct it");
    }
}

/// Checks the first and the last tag, because VTK accepts raw data that are cut off.
void check_ends(const Request& request) {
    std::ifstream in(request.path, std::ios::binary);
    std::string text(4096, '\0');
    in.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(in.gcount()));
    if (text.find("<VTKFile") == std::string::npos || text.find("ImageData") == std::string::npos) {
        throw Failure("is not a VTI file (no VTKFile of type ImageData in it); check its name");
    }
    check_placement(text);
    const auto size = static_cast<std::streamoff>(std::filesystem::file_size(request.path));
    in.clear();
    in.seekg(std::max<std::streamoff>(0, size - 256));
    text.assign(std::istreambuf_iterator<char>(in), {});
    const std::string last = "</VTKFile>";
    const std::string end = trimmed(text);
    if (end.size() < last.size() || end.substr(end.size() - last.size()) != last) {
        throw Failure("it is cut off (no </VTKFile> at its end); copy or download it again");
    }
}

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
    checked_bytes(sizes, 1, std::filesystem::file_size(request.path), request);
}

}  // namespace

Result read_vti(const Request& request) {
    check_ends(request);
    const vtkNew<ErrorKeeper> errors;
    vtkOutputWindow::SetInstance(errors);
    const vtkNew<vtkXMLImageDataReader> reader;
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
    result.geometry = geometry_of(image, at_cells);
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
    if (writer->Write() == 0 || !errors->first().empty()) {
        throw Failure("could not be written (" + errors->first() + "); is the disk full?");
    }
}

}  // namespace palpate::io
