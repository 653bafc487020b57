// Ellipsoids cast by Embree, a peer of `conicoid bench speed`: user geometry, packets as wide as the processor's
// vectors, every core. Written to be fast, in binary32, and writing what Conicoid writes: Z and N.
//
//     embree_ellipsoids SCENE [CONFIGURATION]
//
// CONFIGURATION is Embree's own, as in "isa=avx2,threads=1".
// SCENE: int32 count, width, height, 0; float32 fx, fy, cx, cy; `count` records of 15 float32: centre, radii, and the
// rotation's rows, in camera axes (looking down -z, +y up). Then a line of standard input at a time:
//
//     lap             builds and casts; answers "BUILD CAST", milliseconds
//     picture FILE    casts and writes Z (h, w), N (h, w, 3), both float32, and uint32 numbers from 1, 0 on a miss;
//                     answers "done"
#include <embree3/rtcore.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

namespace {

struct Header {
    int32_t count, width, height, unused;
    float fx, fy, cx, cy;
};

struct Source {
    float centre[3], radii[3], rotation[3][3];
};

// The unit sphere's space from the camera's: rows of a 3 x 3 matrix, which takes points relative to the centre.
struct Ellipsoid {
    float row[3][3], centre[3], half_extent[3];
};

struct Image {
    std::vector<float> depth, normal;
    std::vector<uint32_t> number;
};

template <int W> struct Vectors {
    typedef float Float __attribute__((vector_size(4 * W)));
    typedef int32_t Int __attribute__((vector_size(4 * W)));
};

// RTCRayHit8 and RTCRayHit16, one vector for each of their arrays.
template <int W> struct Packet {
    typename Vectors<W>::Float origin[3], near, direction[3], time, far;
    typename Vectors<W>::Int mask, id, flags;
    typename Vectors<W>::Float normal[3], u, v;
    typename Vectors<W>::Int primitive, geometry, instance;
};
static_assert(sizeof(Packet<8>) == sizeof(RTCRayHit8) && sizeof(Packet<16>) == sizeof(RTCRayHit16));

template <typename Float> Float root(Float x)
{
    for (size_t k = 0; k < sizeof(Float) / 4; k++)
        x[k] = std::sqrt(x[k]);
    return x;
}

void bounds(const RTCBoundsFunctionArguments *arguments)
{
    const Ellipsoid &e = static_cast<const Ellipsoid *>(arguments->geometryUserPtr)[arguments->primID];
    // Rounding moves a corner by some 2^-23 of the centre's distance.
    float slack = 4e-7f * std::max({std::fabs(e.centre[0]), std::fabs(e.centre[1]), std::fabs(e.centre[2])});
    float low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = e.centre[k] - e.half_extent[k] - slack;
        high[k] = e.centre[k] + e.half_extent[k] + slack;
    }
    *arguments->bounds_o = {low[0], low[1], low[2], 0, high[0], high[1], high[2], 0};
}

// Rays leave the origin along (x, y, -1), so that t is the planar depth. Each is taken from where it crosses the
// centre's plane of depth, then from its closest approach: nothing there is larger than the ellipsoid.
template <int W> void intersect(const RTCIntersectFunctionNArguments *arguments)
{
    using Float = typename Vectors<W>::Float;
    using Int = typename Vectors<W>::Int;
    Packet<W> &packet = *reinterpret_cast<Packet<W> *>(arguments->rayhit);
    const Ellipsoid &e = static_cast<const Ellipsoid *>(arguments->geometryUserPtr)[arguments->primID];
    Float x = packet.direction[0], y = packet.direction[1], at = Float{} - e.centre[2];
    Float across = at * x - e.centre[0], up = at * y - e.centre[1];
    Float o[3], d[3];
    for (int k = 0; k < 3; k++) {
        o[k] = e.row[k][0] * across + e.row[k][1] * up;
        d[k] = e.row[k][0] * x + e.row[k][1] * y - e.row[k][2];
    }
    Float a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    Float approach = (o[0] * d[0] + o[1] * d[1] + o[2] * d[2]) / a;
    for (int k = 0; k < 3; k++)
        o[k] -= approach * d[k];
    Float inside = 1.0f - (o[0] * o[0] + o[1] * o[1] + o[2] * o[2]);
    Int valid;
    std::memcpy(&valid, arguments->valid, sizeof valid);
    Int hit = valid & (inside >= 0.0f);
    Int any = hit;
    for (int k = W / 2; k; k /= 2)
        for (int lane = 0; lane < k; lane++)
            any[lane] |= any[lane + k];
    if (!any[0])
        return;
    Float back = root(hit ? inside / a : Float{});
    Float t = at - approach - back;
    hit &= (t > packet.near) & (t < packet.far);
    packet.far = hit ? t : packet.far;
    packet.primitive = hit ? Int{} + static_cast<int32_t>(arguments->primID) : packet.primitive;
    packet.geometry = hit ? Int{} : packet.geometry;
    for (int k = 0; k < 3; k++)
        o[k] -= back * d[k];
    for (int k = 0; k < 3; k++) {
        Float gradient = e.row[0][k] * o[0] + e.row[1][k] * o[1] + e.row[2][k] * o[2];
        packet.normal[k] = hit ? gradient : packet.normal[k];
    }
}

// Packets of 4 x W/4 pixels.
template <int W> void cast(RTCScene scene, const Header &camera, Image &image, bool numbers)
{
    constexpr int COLUMNS = 4, ROWS = W / 4;
    using Float = typename Vectors<W>::Float;
    using Int = typename Vectors<W>::Int;
    auto some_rows = [&](const tbb::blocked_range<int> &range) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        for (int top = range.begin() * ROWS; top < range.end() * ROWS; top += ROWS) {
            for (int left = 0; left < camera.width; left += COLUMNS) {
                Packet<W> packet{};
                Int valid;
                for (int k = 0; k < W; k++) {
                    int i = left + k % COLUMNS, j = top + k / COLUMNS;
                    valid[k] = i < camera.width && j < camera.height ? -1 : 0;
                    packet.direction[0][k] = (i + 0.5f - camera.cx) / camera.fx;
                    packet.direction[1][k] = -(j + 0.5f - camera.cy) / camera.fy;
                }
                packet.direction[2] -= 1.0f;
                packet.far += std::numeric_limits<float>::infinity();
                packet.mask -= 1;
                packet.geometry -= 1;
                auto *rays = reinterpret_cast<int *>(&packet);
                if constexpr (W == 16)
                    rtcIntersect16(reinterpret_cast<int *>(&valid), scene, &context, (RTCRayHit16 *)rays);
                else
                    rtcIntersect8(reinterpret_cast<int *>(&valid), scene, &context, (RTCRayHit8 *)rays);
                Float square = packet.normal[0] * packet.normal[0] + packet.normal[1] * packet.normal[1] +
                               packet.normal[2] * packet.normal[2];
                Float scale = packet.geometry == 0 ? 1.0f / root(square) : Float{};
                for (int k = 0; k < 3; k++)
                    packet.normal[k] *= scale;
                for (int k = 0; k < W; k++) {
                    if (!valid[k])
                        continue;
                    size_t pixel = size_t(top + k / COLUMNS) * camera.width + left + k % COLUMNS;
                    image.depth[pixel] = packet.far[k];
                    for (int axis = 0; axis < 3; axis++)
                        image.normal[3 * pixel + axis] = packet.normal[axis][k];
                    if (numbers)
                        image.number[pixel] = packet.geometry[k] == 0 ? packet.primitive[k] + 1 : 0;
                }
            }
        }
    };
    tbb::parallel_for(tbb::blocked_range<int>(0, (camera.height + ROWS - 1) / ROWS), some_rows);
}

class Peer {
  public:
    Peer(const Header &camera, const std::vector<Source> &sources, const char *configuration)
        : camera_(camera), sources_(sources), ellipsoids_(sources.size()), device_(rtcNewDevice(configuration))
    {
        size_t pixels = size_t(camera.width) * camera.height;
        image_ = {std::vector<float>(pixels), std::vector<float>(3 * pixels), std::vector<uint32_t>(pixels)};
        wide_ = rtcGetDeviceProperty(device_, RTC_DEVICE_PROPERTY_NATIVE_RAY16_SUPPORTED);
    }

    void build()
    {
        tbb::parallel_for(tbb::blocked_range<size_t>(0, sources_.size()), [this](const auto &range) {
            for (size_t n = range.begin(); n < range.end(); n++)
                prepare(n);
        });
        RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
        rtcSetGeometryUserPrimitiveCount(geometry, ellipsoids_.size());
        rtcSetGeometryUserData(geometry, ellipsoids_.data());
        rtcSetGeometryBoundsFunction(geometry, bounds, nullptr);
        rtcSetGeometryIntersectFunction(geometry, wide_ ? intersect<16> : intersect<8>);
        rtcCommitGeometry(geometry);
        scene_ = rtcNewScene(device_);
        rtcAttachGeometry(scene_, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(scene_);
    }

    void cast(bool numbers)
    {
        (wide_ ? ::cast<16> : ::cast<8>)(scene_, camera_, image_, numbers);
    }

    void clear()
    {
        rtcReleaseScene(scene_);
    }

    void write(const std::string &path) const
    {
        std::ofstream file(path, std::ios::binary);
        auto plane = [&](const auto &part) {
            file.write(reinterpret_cast<const char *>(part.data()), part.size() * sizeof part[0]);
        };
        plane(image_.depth);
        plane(image_.normal);
        plane(image_.number);
    }

  private:
    void prepare(size_t n)
    {
        const Source &source = sources_[n];
        Ellipsoid &e = ellipsoids_[n];
        for (int i = 0; i < 3; i++) {
            float square = 0;
            for (int k = 0; k < 3; k++) {
                e.row[k][i] = source.rotation[i][k] / source.radii[k];
                float reach = source.rotation[i][k] * source.radii[k];
                square += reach * reach;
            }
            e.half_extent[i] = std::sqrt(square);
            e.centre[i] = source.centre[i];
        }
    }

    Header camera_;
    const std::vector<Source> &sources_;
    std::vector<Ellipsoid> ellipsoids_;
    Image image_;
    RTCDevice device_;
    RTCScene scene_ = nullptr;
    bool wide_;
};

double now_ms()
{
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

int main(int count, char **arguments)
{
    std::ifstream file(count > 1 ? arguments[1] : "", std::ios::binary);
    Header camera;
    if (!file.read(reinterpret_cast<char *>(&camera), sizeof camera))
        return 2;
    std::vector<Source> sources(camera.count);
    if (!file.read(reinterpret_cast<char *>(sources.data()), sources.size() * sizeof sources[0]))
        return 2;
    Peer peer(camera, sources, count > 2 ? arguments[2] : nullptr);
    for (std::string command; std::getline(std::cin, command);) {
        bool picture = command.rfind("picture ", 0) == 0;
        double start = now_ms();
        peer.build();
        double built = now_ms();
        peer.cast(picture);
        double cast = now_ms();
        peer.clear();
        if (picture) {
            peer.write(command.substr(8));
            std::cout << "done" << std::endl;
        } else {
            std::cout << built - start << ' ' << cast - built << std::endl;
        }
    }
}
