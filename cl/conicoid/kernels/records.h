// What set-up hands to casting, one record per visible quadric. All polynomials are in pixels (u, v) about the
// record's integer `centre`: quadratic ones have the coefficients uu, uv, vv, u, v, 1; linear ones u, v, 1.
//
// Notation: X + tY is the ray in parameter space, four coordinates, X4 = 1, Y4 = 0; D the quadric's form there.
// a = Y'DY, b = X'DY, c = X'DX, S = b^2 - ac. F is the one of X, Y that is the same at every pixel (X for a
// pinhole, Y for orthographic rays), V the other.

#define QUADRATIC 6
#define LINEAR 3

#define TILE 16                 // pixels of a tile's side
#define UNIT_ROUNDOFF 0x1p-53

// What a tile's list points at, in depth order: where a quadric can be seen, and, of a closed surface wholly in front of
// the camera, kept whole, all there is to know. Its nearest hit is one formula,
//     key = b + sqrt(S),  key = 1/t (pinhole), -t (orthographic),
// with b and S divided by F'DF and (F'DF)^2, and so f > 0 outside is (1 - b t)^2 - S t^2 but for a factor, (t + b)^2 - S
// with parallel rays: its gradient follows from S and b too.
typedef struct {
    double s[QUADRATIC];
    double b[LINEAR];
    // Bounds of errors anywhere in the tiles that the box touches; infinite where nothing is known.
    float s_error;              // of S, evaluated
    float slop;                 // of the key, whatever the root
    float key_error;            // of the key, but for the root's
    float n_error, root_norm;   // of the gradient's length, but for the root's, which counts root_norm times
    float nearest;              // no key of this slot, or of any behind it, is larger
    int centre[2];
    int box[4];                 // pixels [x0, x1) x [y0, y1)
    int general;                // row of the general record, -1 for the above
    int quadric;                // place in the document
} slot_record;

// Any quadric with any extent. What casting reads comes first, in ten lines of a cache.
typedef struct {
    double slab[3][4];          // the image is where low <= nu u + nv v <= high: nu, nv, low, high; all 0 where unknown
    int centre[2];
    int flags;
    // By kind of hit (candidates.h). A flat piece whose half-spaces exact arithmetic has reduced to lines across the
    // image is `placed`: its bit, and 16 times its bit where it is never seen; its list holds those lines alone.
    int placed;
    int clip_start[4], clip_count[4];
    int drowned;                // whether a, b, c or S is no larger than what set-up may have lost
    double s[QUADRATIC];
    double a[QUADRATIC];
    double b[LINEAR];
    double c[QUADRATIC];
    double range[2][LINEAR];    // X3 - z0/c, X3 - z1/c
    double end[2];              // |z0/c|, |z1/c|
    double cap[2][QUADRATIC];   // f at the point where the ray meets z = z0, z1, times Y3^2
    double y[3][LINEAR];
    // What set-up itself may have lost: sizes that its double-doubles had before anything cancelled.
    double kappa;               // condition of the placement
    double fixed_norm, moving_norm[LINEAR];
    double moment_norm[LINEAR]; // of the six Pluecker coordinates, after cancelling
    double form_sum, spatial_sum, compound_sum;  // sums of |Dij|, of those with i, j <= 3, of D's |2x2 minors|
    double x[3][LINEAR];
    double moment[3][LINEAR];   // L12, L13, L23 with Lij = Xi Yj - Xj Yi
    double form[10];            // D11 D12 D13 D14 D22 D23 D24 D33 D34 D44
    double normal[3][3];        // target normal = normal x parameter-space gradient
    // With SHEETS: what tells which root is which, and the sheets' normals that face the eye.
    double sheet[LINEAR];
    double face[2][3];
} general_record;

#define HAS_RANGE 1
#define HAS_CAPS 2
#define ALWAYS_REAL 4   // plane pairs: S is a square, so rounding below zero is no miss
#define SINGULAR 8      // the gradient vanishes at every real point: double planes, lines, points
#define FLAT 16         // z0 = z1: both caps are one, and the first wins
#define ORTHOGRAPHIC 32
#define RISING 128      // f's quadratic part is never negative: a >= 0
#define SHEETS 64       // two placed planes: the kinds of the roots mean the first and the second

// A half-space as seen along the rays: (n.X + d) + t (n.Y) >= 0, linear in absolute pixels.
typedef struct {
    double offset[LINEAR];
    double slope[LINEAR];
} clip_record;

// A plane among planes that nearly coincide on the image: its key, less that of the first of its cluster, in absolute
// pixels. Equal places are one set of points.
typedef struct {
    double lead[LINEAR];
    int cluster;                // -1: nothing is known
} plane_record;
