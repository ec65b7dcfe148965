// Compresses DICOM files with GDCM.
#include "dicom_transcoder.hpp"

#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>

namespace palpate::io::test {

bool compress_dicom(const std::filesystem::path& from, const std::filesystem::path& to,
                    Compression compression) {
    constexpr gdcm::TransferSyntax::TSType syntaxes[] = {
        gdcm::TransferSyntax::JPEGLosslessProcess14_1, gdcm::TransferSyntax::JPEGLSLossless,
        gdcm::TransferSyntax::JPEG2000Lossless, gdcm::TransferSyntax::RLELossless};
    gdcm::ImageReader reader;
    reader.SetFileName(from.c_str());
    if (!reader.Read()) return false;
    gdcm::ImageChangeTransferSyntax change;
    change.SetTransferSyntax(gdcm::TransferSyntax(syntaxes[static_cast<int>(compression)]));
    change.SetInput(reader.GetImage());
    if (!change.Change()) return false;
    gdcm::ImageWriter writer;
    writer.SetFileName(to.c_str());
    writer.SetFile(reader.GetFile());
    writer.SetImage(change.GetOutput());
    return writer.Write();
}

}  // namespace palpate::io::test
