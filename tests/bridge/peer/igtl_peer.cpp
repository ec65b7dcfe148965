// A client or server made of OpenIGTLink's own library, as 3D Slicer is: igtl_peer connect|listen
// PORT ACTION... Prints a line a message, but for poses.
// Actions: poses COUNT (until so many of each kind have come), status TEXT (until a status has it),
// await TYPE, string TEXT, image NAME SIZE LEVEL, surface, garbage.
#include <igtlClientSocket.h>
#include <igtlImageMessage.h>
#include <igtlPolyDataMessage.h>
#include <igtlServerSocket.h>
#include <igtlStatusMessage.h>
#include <igtlStringMessage.h>
#include <igtlTransformMessage.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <map>
#include <string>

namespace {

class Peer {
  public:
    explicit Peer(igtl::Socket::Pointer socket) : socket_(socket) {}

    void send(igtl::MessageBase* message) {
        message->Pack();
        socket_->Send(message->GetPackPointer(), message->GetPackSize());
    }

    /// The type of the message that came; empty at the end.
    std::string receive() {
        auto header = igtl::MessageHeader::New();
        header->InitPack();
        if (socket_->Receive(header->GetPackPointer(), header->GetPackSize()) !=
            header->GetPackSize()) {
            return {};
        }
        header->Unpack();
        const std::string type = header->GetDeviceType();
        const char* const name = header->GetDeviceName();
        if (type == "TRANSFORM") {
            auto message = body<igtl::TransformMessage>(header);
            igtl::Matrix4x4 m;
            message->GetMatrix(m);
            ++counts_[name];
            std::snprintf(last_[name], sizeof last_[name], "%.6g %.6g %.6g", double(m[0][3]),
                          double(m[1][3]), double(m[2][3]));
        } else if (type == "STATUS") {
            auto message = body<igtl::StatusMessage>(header);
            status_ = std::to_string(message->GetCode()) + " " + message->GetStatusString();
        } else if (type == "STRING") {
            std::printf("%s %s\n", name, body<igtl::StringMessage>(header)->GetString());
        } else if (type == "POLYDATA") {
            auto message = body<igtl::PolyDataMessage>(header);
            igtlFloat32 point[3];
            double farthest = 0;
            const int points = message->GetPoints()->GetNumberOfPoints();
            for (int i = 0; i < points; ++i) {
                message->GetPoints()->GetPoint(unsigned(i), point);
                const double r2 = double(point[0]) * point[0] + double(point[1]) * point[1] +
                                  double(point[2]) * point[2];
                farthest = std::max(farthest, r2);
            }
            std::printf("surface %d points %d polygons, to %.3g\n", points,
                        int(message->GetPolygons()->GetNumberOfCells()), std::sqrt(farthest));
        } else {
            socket_->Skip(header->GetBodySizeToRead(), 0);
        }
        return type;
    }

    /// Until so many poses of each kind have come; false at the end.
    bool receive_poses(int wanted) {
        counts_.clear();
        const auto has_all = [&] {
            return counts_.size() == 4 &&
                   std::all_of(counts_.begin(), counts_.end(),
                               [&](auto& one) { return one.second >= wanted; });
        };
        while (!has_all()) {
            if (receive().empty()) return false;
        }
        for (const auto& [name, count] : counts_) {
            std::printf("%s at %s\n", name.c_str(), last_[name]);
        }
        std::printf("status %s\n", status_.c_str());
        return true;
    }

    /// Until a status has the text; false at the end.
    bool receive_status(const std::string& text) {
        for (status_.clear(); status_.find(text) == std::string::npos;) {
            if (receive().empty()) return false;
        }
        return true;
    }

    void garbage() {
        const std::string bytes(200, 'x');
        socket_->Send(bytes.data(), int(bytes.size()));
    }

  private:
    template <class Message>
    typename Message::Pointer body(igtl::MessageHeader::Pointer& header) {
        auto message = Message::New();
        message->SetMessageHeader(header);
        message->AllocatePack();
        socket_->Receive(message->GetPackBodyPointer(), message->GetPackBodySize());
        if (!(message->Unpack(1) & igtl::MessageHeader::UNPACK_BODY)) std::printf("BAD CHECKSUM\n");
        return message;
    }

    igtl::Socket::Pointer socket_;
    std::map<std::string, int> counts_;
    std::map<std::string, char[96]> last_;
    std::string status_;
};

/// A ball in the middle: `level` inside half the size, 0 outside, 2 mm apart.
igtl::ImageMessage::Pointer ball(const char* name, int size, double level) {
    auto image = igtl::ImageMessage::New();
    image->SetDeviceName(name);
    image->SetDimensions(size, size, size);
    image->SetSpacing(2, 2, 2);
    image->SetScalarType(igtl::ImageMessage::TYPE_UINT8);
    image->AllocateScalars();
    igtl::Matrix4x4 place;
    igtl::IdentityMatrix(place);
    image->SetMatrix(place);
    auto* at = static_cast<unsigned char*>(image->GetScalarPointer());
    const double middle = 0.5 * (size - 1);
    for (int k = 0; k < size; ++k) {
        for (int j = 0; j < size; ++j) {
            for (int i = 0; i < size; ++i) {
                const double r =
                    std::sqrt((i - middle) * (i - middle) + (j - middle) * (j - middle) +
                              (k - middle) * (k - middle));
                *at++ = static_cast<unsigned char>(
                    level * std::min(1.0, std::max(0.0, 1.5 - 4 * r / size)));
            }
        }
    }
    return image;
}

igtl::Socket::Pointer socket_for(const std::string& role, int port) {
    if (role == "connect") {
        auto client = igtl::ClientSocket::New();
        if (client->ConnectToServer("127.0.0.1", port) != 0) return nullptr;
        return client.GetPointer();
    }
    auto server = igtl::ServerSocket::New();
    if (server->CreateServer(port) != 0) return nullptr;
    auto client = server->WaitForConnection(20000);
    return client.GetPointer();
}

int act(Peer& peer, int argc, char** argv) {
    for (int i = 3; i < argc; ++i) {
        const std::string action = argv[i];
        if (action == "poses") {
            if (!peer.receive_poses(std::stoi(argv[++i]))) return 3;
        } else if (action == "status") {
            if (!peer.receive_status(argv[++i])) return 3;
        } else if (action == "string") {
            auto message = igtl::StringMessage::New();
            message->SetDeviceName("Command");
            message->SetString(argv[++i]);
            peer.send(message);
        } else if (action == "image") {
            auto image = ball(argv[i + 1], std::stoi(argv[i + 2]), std::stod(argv[i + 3]));
            i += 3;
            peer.send(image);
        } else if (action == "surface") {
            auto message = igtl::GetPolyDataMessage::New();
            message->SetDeviceName("Surface");
            peer.send(message);
        } else if (action == "await") {
            const std::string wanted = argv[++i];
            for (std::string got; got != wanted;) {
                got = peer.receive();
                if (got.empty()) return 3;
            }
        } else if (action == "garbage") {
            peer.garbage();
        }
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3) return 2;
    const auto socket = socket_for(argv[1], std::stoi(argv[2]));
    if (socket.IsNull()) return 4;
    Peer peer(socket);
    const int status = act(peer, argc, argv);
    std::fflush(stdout);
    return status;
}
