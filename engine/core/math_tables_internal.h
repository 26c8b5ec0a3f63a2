// Written by tools/math/generate.py, which says how each number was derived. Do not edit.
#ifndef CORE_MATH_TABLES_INTERNAL_H
#define CORE_MATH_TABLES_INTERNAL_H

#include <stdint.h>

// clang-format off
// pi/2 in parts whose products with a whole number below 2^20 are exact
#define HALF_PI_1 0x1.921fb54400000p+0
#define HALF_PI_2 0x1.0b4611a600000p-34
#define HALF_PI_3 0x1.3198a2e000000p-69
#define HALF_PI_4 0x1.b839a252049c1p-104
#define HALF_PI_HI 0x1.921fb54442d18p+0
#define HALF_PI_LO 0x1.1a62633145c07p-54
#define PI_HI 0x1.921fb54442d18p+1
#define PI_LO 0x1.1a62633145c07p-53
#define TWO_OVER_PI 0x1.45f306dc9c883p-1
// ln 2: the first part times a whole number below 2^11 is exact
#define LN2_1 0x1.62e42fefa4000p-1
#define LN2_2 -0x1.8432a1b0e2634p-43
#define ONE_OVER_LN2 0x1.71547652b82fep+0
#define LOG2_E_HI 0x1.71547652b82fep+0
#define LOG2_E_LO 0x1.777d0ffda0d24p-56
#define LOG10_E_HI 0x1.bcb7b1526e50ep-2
#define LOG10_E_LO 0x1.95355baaafad3p-57
#define LOG10_2_HI 0x1.34413509f79ffp-2
#define LOG10_2_LO -0x1.9dc1da994fd21p-59
// float: pi/2 in parts whose products with a whole number below 2^8 are exact
#define HALF_PIF_1 0x1.9220000000000p+0f
#define HALF_PIF_2 -0x1.2aee000000000p-18f
#define HALF_PIF_3 -0x1.e974000000000p-35f
#define HALF_PIF_4 0x1.1a62640000000p-54f
#define TWO_OVER_PIF 0x1.45f3060000000p-1f
// float: pi/4; the first part times 0..4 is exact
#define QUARTER_PIF_1 0x1.921fb80000000p-1f
#define QUARTER_PIF_2 -0x1.5dde980000000p-24f
#define TAN_PI_8F 0x1.a8279a0000000p-2f
#define LN2F_1 0x1.62e4000000000p-1f
#define LN2F_2 0x1.7f7d1c0000000p-20f
#define ONE_OVER_LN2F 0x1.7154760000000p+0f
// sin(x) = x + x^3 p(x^2), |x| <= pi/4; relative error of the approximation 2^-57.9
static const double poly_sin[6] = {
    -0x1.5555555555548p-3,
    0x1.111111110f730p-7,
    -0x1.a01a019be921ap-13,
    0x1.71de35552bbadp-19,
    -0x1.ae5e4b846b909p-26,
    0x1.5d8b55cb40a60p-33,
};
// cos(x) = 1 - x^2/2 + x^4 p(x^2), |x| <= pi/4; relative error of the approximation 2^-63.9
static const double poly_cos[6] = {
    0x1.555555555554bp-5,
    -0x1.6c16c16c15013p-10,
    0x1.a01a019c8ed07p-16,
    -0x1.27e4f7f1410f7p-22,
    0x1.1ee9db8e3250dp-29,
    -0x1.8fa65e944a67dp-37,
};
// asin(x) = x + x^3 p(x^2), |x| <= 1/2; relative error of the approximation 2^-59.9
static const double poly_asin[13] = {
    0x1.5555555555577p-3,
    0x1.333333332e10bp-4,
    0x1.6db6db7215407p-5,
    0x1.f1c71a93982c6p-6,
    0x1.6e8bdf0cc0de6p-6,
    0x1.1c49ecdf1ee7cp-6,
    0x1.ca1fe8bf2dedfp-7,
    0x1.7582677da2eecp-7,
    0x1.614f338e7a577p-7,
    0x1.e4cc93ecd43d5p-9,
    0x1.63fb0b4e850a9p-6,
    -0x1.58890ee0f133ap-6,
    0x1.0b7412f897bc5p-5,
};
// atan(x) = x + x^3 p(x^2), |x| <= 7/32; relative error of the approximation 2^-60.9
static const double poly_atan[8] = {
    -0x1.5555555555543p-2,
    0x1.9999999993884p-3,
    -0x1.2492491f13587p-3,
    0x1.c71c6cf4fa7b8p-4,
    -0x1.745beb31b0daap-4,
    0x1.3ae903a13bf0fp-4,
    -0x1.0d84ddb2b103cp-4,
    0x1.8f28596a012c4p-5,
};
// exp(x) = 1 + x + x^2 p(x), |x| <= ln(2)/2; relative error of the approximation 2^-62.6
static const double poly_exp[11] = {
    0x1.0000000000000p-1,
    0x1.555555555555dp-3,
    0x1.555555555556cp-5,
    0x1.111111110e549p-7,
    0x1.6c16c16c0a40dp-10,
    0x1.a01a01b5f5754p-13,
    0x1.a01a01e8b0d29p-16,
    0x1.71ddeaa30f3fep-19,
    0x1.27e44d84288bdp-22,
    0x1.af7474750acacp-26,
    0x1.20435663aec6ep-29,
};
// log(1+x) = x - x^2/2 + x^3 p(x), |x| <= 1/150; relative error of the approximation 2^-73.9
static const double poly_log1p[7] = {
    0x1.5555555555555p-2,
    -0x1.000000000003cp-2,
    0x1.99999999b2250p-3,
    -0x1.55555549ff68dp-3,
    0x1.249239cf905e9p-3,
    -0x1.000556712a906p-3,
    0x1.cccb1a8ba0519p-4,
};
// sinh(x) = x + x^3 p(x^2), |x| <= 1; relative error of the approximation 2^-61.8
static const double poly_sinh[7] = {
    0x1.5555555555556p-3,
    0x1.111111111101ep-7,
    0x1.a01a01a037268p-13,
    0x1.71de3a3b06dbbp-19,
    0x1.ae646ff4e5045p-26,
    0x1.6116f4b4b80bbp-33,
    0x1.b5c88f764286fp-41,
};
// cosh(x) = 1 + x^2/2 + x^4 p(x^2), |x| <= 0.6; relative error of the approximation 2^-59.1
static const double poly_cosh[5] = {
    0x1.55555555557b9p-5,
    0x1.6c16c16b8e419p-10,
    0x1.a01a02ffd5870p-16,
    0x1.27e357c84401ap-22,
    0x1.20c538c7fb90ep-29,
};

// float: sin(x) = x + x^3 p(x^2), |x| <= pi/4; relative error of the approximation 2^-27.9
static const float poly_sinf[3] = {
    -0x1.5555460000000p-3f,
    0x1.1107780000000p-7f,
    -0x1.9954000000000p-13f,
};
// float: cos(x) = 1 - x^2/2 + x^4 p(x^2), |x| <= pi/4; relative error of the approximation 2^-33.0
static const float poly_cosf[3] = {
    0x1.55554a0000000p-5f,
    -0x1.6c0c280000000p-10f,
    0x1.99e80c0000000p-16f,
};
// float: asin(x) = x + x^3 p(x^2), |x| <= 1/2; relative error of the approximation 2^-27.6
static const float poly_asinf[5] = {
    0x1.5555c80000000p-3f,
    0x1.3301fc0000000p-4f,
    0x1.747d060000000p-5f,
    0x1.8c2d840000000p-6f,
    0x1.596d600000000p-5f,
};
// float: atan(x) = x + x^3 p(x^2), |x| <= tan(pi/8); relative error of the approximation 2^-30.4
static const float poly_atanf[5] = {
    -0x1.55554a0000000p-2f,
    0x1.9991e20000000p-3f,
    -0x1.23b9a20000000p-3f,
    0x1.b224560000000p-4f,
    -0x1.f2e5a80000000p-5f,
};
// float: exp(x) = 1 + x + x^2 p(x), |x| <= ln(2)/2; relative error of the approximation 2^-28.2
static const float poly_expf[5] = {
    0x1.fffffc0000000p-2f,
    0x1.55548c0000000p-3f,
    0x1.55585a0000000p-5f,
    0x1.123d5c0000000p-7f,
    0x1.6ab6c00000000p-10f,
};
// float: log(m) = 2s + s^3 p(s^2), s = (m-1)/(m+1), m in [sqrt(1/2), sqrt(2)]; relative error of the approximation 2^-30.2
static const float poly_logf[3] = {
    0x1.55557a0000000p-1f,
    0x1.995ed80000000p-2f,
    0x1.31e03c0000000p-2f,
};
// [i - 90]: c with at most 11 bits, near 128/i; then -log(c), high and low part
static const double table_log[92][3] = {
    {0x1.6c00000000000p+0, -0x1.686c81e9b14afp-2, 0x1.ddea0f7f58e3dp-57},
    {0x1.6800000000000p+0, -0x1.5d1bdbf5809cap-2, -0x1.4236383dc7fe1p-56},
    {0x1.6440000000000p+0, -0x1.5262deeb98879p-2, -0x1.823ddad7fcfa1p-58},
    {0x1.6040000000000p+0, -0x1.46d2d9c280567p-2, 0x1.b14130114bd36p-57},
    {0x1.5c80000000000p+0, -0x1.3bdd24eb14b6ap-2, -0x1.2da3c6449a7d0p-58},
    {0x1.5900000000000p+0, -0x1.31871c9544185p-2, 0x1.51acc4c09b379p-60},
    {0x1.5540000000000p+0, -0x1.26561f133862dp-2, -0x1.10cdf548bd15cp-57},
    {0x1.51c0000000000p+0, -0x1.1bc794fd1c8ccp-2, -0x1.e71708b083dbdp-57},
    {0x1.4e40000000000p+0, -0x1.111ce4003ee4dp-2, 0x1.1b84b5a5b5b2ap-57},
    {0x1.4b00000000000p+0, -0x1.071b85fcd590dp-2, -0x1.d1707f97bde80p-58},
    {0x1.47c0000000000p+0, -0x1.fa01c3bb57cbcp-3, -0x1.1c0a3c50f47adp-59},
    {0x1.4480000000000p+0, -0x1.e598ed5a87e2fp-3, 0x1.a5e78f4c50659p-58},
    {0x1.4140000000000p+0, -0x1.d0fb7f2255e51p-3, 0x1.4ac818ceca4c4p-57},
    {0x1.3e40000000000p+0, -0x1.bdc46ae344b13p-3, 0x1.2ff70a6bea623p-58},
    {0x1.3b00000000000p+0, -0x1.a8becfc882f19p-3, 0x1.e8c37918c39ebp-58},
    {0x1.3800000000000p+0, -0x1.9525a9cf456b4p-3, -0x1.d904c1d4e2e26p-57},
    {0x1.3540000000000p+0, -0x1.83040c91bcf2ep-3, 0x1.1c7233219bcc5p-57},
    {0x1.3240000000000p+0, -0x1.6f0d28ae56b4cp-3, 0x1.906d99184b992p-57},
    {0x1.2f80000000000p+0, -0x1.5c940075972b9p-3, -0x1.adccb73379cc5p-58},
    {0x1.2c80000000000p+0, -0x1.483bccce6e3ddp-3, -0x1.29391fb1b4b22p-57},
    {0x1.2a00000000000p+0, -0x1.371fc201e8f74p-3, -0x1.de6cb62af18a0p-58},
    {0x1.2740000000000p+0, -0x1.2423113ba50e3p-3, 0x1.e3ba766fc9a72p-66},
    {0x1.2480000000000p+0, -0x1.10f8e422539b1p-3, -0x1.8f798d39f1b7dp-58},
    {0x1.2200000000000p+0, -0x1.fec9131dbeabbp-4, 0x1.5746b9981b36cp-58},
    {0x1.1f80000000000p+0, -0x1.db5270187d927p-4, -0x1.e15ab8607d2acp-58},
    {0x1.1d00000000000p+0, -0x1.b78c82bb0eda1p-4, -0x1.0878cf0327e21p-61},
    {0x1.1a80000000000p+0, -0x1.9375e55595edep-4, 0x1.e463f9e4dd920p-59},
    {0x1.1800000000000p+0, -0x1.6f0d28ae56b4cp-4, 0x1.906d99184b992p-58},
    {0x1.15c0000000000p+0, -0x1.4e01108a35ae6p-4, 0x1.81069d28db75bp-59},
    {0x1.1340000000000p+0, -0x1.28f83450eda8dp-4, -0x1.d6a8465da24a3p-58},
    {0x1.1100000000000p+0, -0x1.075983598e471p-4, -0x1.80da5333c45b8p-59},
    {0x1.0ec0000000000p+0, -0x1.cae72fb95c20bp-5, 0x1.f9012d8df3f0ep-59},
    {0x1.0c80000000000p+0, -0x1.868a83083f6cfp-5, 0x1.d09a5634943dbp-61},
    {0x1.0a80000000000p+0, -0x1.494acc34d911cp-5, -0x1.e295bf491ccc5p-59},
    {0x1.0840000000000p+0, -0x1.03d5d85e73eefp-5, -0x1.2c1da539d60edp-61},
    {0x1.0640000000000p+0, -0x1.8b31faca9b00ep-6, -0x1.d5a46da6f6772p-62},
    {0x1.0400000000000p+0, -0x1.fc0a8b0fc03e4p-7, 0x1.83092c59642a1p-62},
    {0x1.0200000000000p+0, -0x1.fe02a6b106789p-8, 0x1.e44b7e3711ebfp-67},
    {0x1.0000000000000p+0, 0x0p+0, 0x0p+0},
    {0x1.fc00000000000p-1, 0x1.010157588de71p-7, 0x1.46662d417ced0p-62},
    {0x1.f800000000000p-1, 0x1.0205658935847p-6, 0x1.27c8e8416e71fp-60},
    {0x1.f480000000000p-1, 0x1.74321d3d006d3p-6, -0x1.96f016b887bf4p-60},
    {0x1.f080000000000p-1, 0x1.f7a9b16782856p-6, -0x1.36c720c147756p-60},
    {0x1.ed00000000000p-1, 0x1.35c8bfaa1306bp-5, -0x1.50830a65543a4p-63},
    {0x1.e900000000000p-1, 0x1.788595a3577bap-5, 0x1.e5ef898b67923p-59},
    {0x1.e580000000000p-1, 0x1.b35dd9b58baadp-5, -0x1.6526154e379dfp-61},
    {0x1.e200000000000p-1, 0x1.eea31c006b87cp-5, -0x1.3e4fc93b7b66cp-59},
    {0x1.de80000000000p-1, 0x1.152b799bb3cc9p-4, -0x1.948381841487fp-58},
    {0x1.db00000000000p-1, 0x1.333d7f8183f4bp-4, 0x1.a92afc8ef70b1p-58},
    {0x1.d780000000000p-1, 0x1.518874226130ap-4, 0x1.d96258b3d8a8fp-60},
    {0x1.d400000000000p-1, 0x1.700d30aeac0e1p-4, -0x1.72566212cdd05p-61},
    {0x1.d100000000000p-1, 0x1.8a6477a91dc29p-4, -0x1.fa83214904842p-59},
    {0x1.cd80000000000p-1, 0x1.a956d3ecade63p-4, 0x1.e5300b12bd55ep-58},
    {0x1.ca80000000000p-1, 0x1.c40d6425a5cb1p-4, 0x1.21d1930dc8acdp-60},
    {0x1.c700000000000p-1, 0x1.e3707ee30487bp-4, 0x1.09ccecd579d99p-58},
    {0x1.c400000000000p-1, 0x1.fe89139dbd566p-4, -0x1.ac9f4215f9393p-58},
    {0x1.c100000000000p-1, 0x1.0ce7ecdccc28dp-3, -0x1.692a0055dc959p-57},
    {0x1.be00000000000p-1, 0x1.1aa2b7e23f72ap-3, -0x1.c6ef1d9b2ef7ep-59},
    {0x1.bb00000000000p-1, 0x1.28753bc11aba5p-3, -0x1.6394d9fa33311p-57},
    {0x1.b800000000000p-1, 0x1.365fcb0159016p-3, 0x1.7d411a5b944adp-58},
    {0x1.b500000000000p-1, 0x1.4462b9dc9b3dcp-3, -0x1.629c46c186385p-58},
    {0x1.b200000000000p-1, 0x1.527e5e4a1b58dp-3, -0x1.71a9682395bfdp-61},
    {0x1.af00000000000p-1, 0x1.60b3100b09476p-3, -0x1.5b2623e05016bp-58},
    {0x1.ac80000000000p-1, 0x1.6c9d07d203fc7p-3, 0x1.80a04c9a46c61p-59},
    {0x1.a980000000000p-1, 0x1.7b0091651528cp-3, 0x1.4069f303518c8p-57},
    {0x1.a700000000000p-1, 0x1.871213750e994p-3, 0x1.d685f35eea2a0p-57},
    {0x1.a400000000000p-1, 0x1.95a5adcf7017fp-3, 0x1.142c507fb7a3dp-58},
    {0x1.a180000000000p-1, 0x1.a1dfc40f1b7f1p-3, -0x1.e009e6f018fe8p-61},
    {0x1.9f00000000000p-1, 0x1.ae2ca6f672bd4p-3, 0x1.ab5ca9eaa088ap-57},
    {0x1.9c00000000000p-1, 0x1.bd087383bd8adp-3, 0x1.dd355f6a516d7p-60},
    {0x1.9980000000000p-1, 0x1.c97f8079d44ecp-3, 0x1.61a8c6e6c4ee7p-57},
    {0x1.9700000000000p-1, 0x1.d60a17f903515p-3, -0x1.c0df841a71b7ap-57},
    {0x1.9480000000000p-1, 0x1.e2a877a6b2c12p-3, -0x1.fa21e3df99430p-58},
    {0x1.9200000000000p-1, 0x1.ef5ade4dcffe6p-3, -0x1.08ab2ddc708a0p-58},
    {0x1.8f80000000000p-1, 0x1.fc218be620a5ep-3, -0x1.6e438c258187fp-58},
    {0x1.8d00000000000p-1, 0x1.047e60cde83b8p-2, -0x1.0779634061cbcp-56},
    {0x1.8b00000000000p-1, 0x1.09aa572e6c6d4p-2, 0x1.43c2e68684d53p-57},
    {0x1.8880000000000p-1, 0x1.102ac0a35cc1cp-2, 0x1.088080a5e68b4p-59},
    {0x1.8600000000000p-1, 0x1.16b5ccbacfb73p-2, 0x1.66fbd28b40935p-56},
    {0x1.8400000000000p-1, 0x1.1bf99635a6b95p-2, -0x1.12aeb84249223p-57},
    {0x1.8180000000000p-1, 0x1.22981fbef797bp-2, -0x1.0b04ac06cebe0p-59},
    {0x1.7f80000000000p-1, 0x1.27ebaf58d8c9dp-2, -0x1.8800b4bda6c97p-57},
    {0x1.7d00000000000p-1, 0x1.2e9e2bce12286p-2, 0x1.8251a3b83d97ap-62},
    {0x1.7b00000000000p-1, 0x1.3401e12aecba1p-2, -0x1.cd55b8a4746c0p-58},
    {0x1.7880000000000p-1, 0x1.3ac8ca38e5c5fp-2, -0x1.f7de015f253eep-56},
    {0x1.7680000000000p-1, 0x1.403d086cea79cp-2, -0x1.0a8bb78cf7cdap-56},
    {0x1.7480000000000p-1, 0x1.45b8c0a17df13p-2, 0x1.dbe305eaf5a20p-56},
    {0x1.7280000000000p-1, 0x1.4b3c077267e9ap-2, 0x1.2e5fbeb518508p-56},
    {0x1.7000000000000p-1, 0x1.522ae0738a3d8p-2, -0x1.8f7e9b38a6979p-57},
    {0x1.6e00000000000p-1, 0x1.57bf753c8d1fbp-2, -0x1.0908d15f88b63p-57},
    {0x1.6c00000000000p-1, 0x1.5d5bddf595f30p-2, -0x1.6541148cbb8a2p-56},
    {0x1.6a00000000000p-1, 0x1.630030b3aac49p-2, 0x1.dc18ce51fff99p-57},
};
// [i]: atan(i/16), high and low part
static const double table_atan[17][2] = {
    {0x0p+0, 0x0p+0},
    {0x1.ff55bb72cfdeap-5, -0x1.c934d86d23f1dp-60},
    {0x1.fd5ba9aac2f6ep-4, -0x1.cd37686760c17p-59},
    {0x1.7b97b4bce5b02p-3, 0x1.347b0b4f881cap-58},
    {0x1.f5b75f92c80ddp-3, 0x1.8ab6e3cf7afbdp-57},
    {0x1.362773707ebccp-2, -0x1.963a544b672d8p-57},
    {0x1.6f61941e4def1p-2, -0x1.c63aae6f6e918p-56},
    {0x1.a64eec3cc23fdp-2, -0x1.24dec1b50b7ffp-56},
    {0x1.dac670561bb4fp-2, 0x1.a2b7f222f65e2p-56},
    {0x1.0657e94db30d0p-1, -0x1.d5b495f6349e6p-56},
    {0x1.1e00babdefeb4p-1, -0x1.928df287a668fp-58},
    {0x1.345f01cce37bbp-1, 0x1.1021137c71102p-55},
    {0x1.4978fa3269ee1p-1, 0x1.2419a87f2a458p-56},
    {0x1.5d58987169b18p-1, 0x1.0028e4bc5e7cap-57},
    {0x1.700a7c5784634p-1, -0x1.8c34d25aadef6p-56},
    {0x1.819d0b7158a4dp-1, -0x1.bf76229d3b917p-56},
    {0x1.921fb54442d18p-1, 0x1.1a62633145c07p-55},
};
// 2/pi: its first 1280 bits after the point, most significant word first
static const uint64_t table_two_over_pi[20] = {
    0xa2f9836e4e441529u,
    0xfc2757d1f534ddc0u,
    0xdb6295993c439041u,
    0xfe5163abdebbc561u,
    0xb7246e3a424dd2e0u,
    0x06492eea09d1921cu,
    0xfe1deb1cb129a73eu,
    0xe88235f52ebb4484u,
    0xe99c7026b45f7e41u,
    0x3991d639835339f4u,
    0x9c845f8bbdf9283bu,
    0x1ff897ffde05980fu,
    0xef2f118b5a0a6d1fu,
    0x6d367ecf27cb09b7u,
    0x4f463f669e5fea2du,
    0x7527bac7ebe5f17bu,
    0x3d0739f78a5292eau,
    0x6bfb5fb11f8d5d08u,
    0x56033046fc7b6babu,
    0xf0cfbc209af4361du,
};
// clang-format on

#endif
