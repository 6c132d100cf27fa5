//! Tables of joint names of more programs, compared where those of `names.rs` do not give all limbs.
//!
//! **MMD** moves the trunk from two joints side by side, upper and lower body; the legs are below the latter. **Vicon** and the
//! last table stand for many: names of anatomy, and those that people choose who build a rig by hand.

use super::names::VocabularyText;

pub(super) const MORE: [VocabularyText; 11] = [
    VocabularyText {
        name: "OptiTrack",
        sides: ["l", "r"],
        central: "pelvis=hip|hips spine_01=ab neck_01=neck head=head",
        sided: "thigh=*thigh calf=*shin foot=*foot ball=*toe clavicle=*shoulder upperarm=*uarm lowerarm=*farm \
                hand=*hand thumb_01=*thumb1 thumb_02=*thumb2 thumb_03=*thumb3 index_01=*index1 index_02=*index2 \
                index_03=*index3 middle_01=*middle1 middle_02=*middle2 middle_03=*middle3 ring_01=*ring1 \
                ring_02=*ring2 ring_03=*ring3 pinky_01=*pinky1 pinky_02=*pinky2 pinky_03=*pinky3",
    },
    VocabularyText {
        name: "Character Creator",
        sides: ["l", "r"],
        central: "pelvis=hip spine_01=waist spine_02=spine01 spine_03=spine02 neck_01=necktwist01 head=head \
                  jaw=jawroot",
        sided: "thigh=*thigh calf=*calf foot=*foot ball=*toebase clavicle=*clavicle upperarm=*upperarm \
                lowerarm=*forearm hand=*hand eye=*eye thumb_01=*thumb1 thumb_02=*thumb2 thumb_03=*thumb3 \
                index_01=*index1 index_02=*index2 index_03=*index3 middle_01=*mid1 middle_02=*mid2 middle_03=*mid3 \
                ring_01=*ring1 ring_02=*ring2 ring_03=*ring3 pinky_01=*pinky1 pinky_02=*pinky2 pinky_03=*pinky3",
    },
    VocabularyText {
        name: "AdvancedSkeleton",
        sides: ["l", "r"],
        central: "pelvis=root|pelvis spine_01=spine1 neck_01=neck head=head jaw=jaw",
        sided: "thigh=hip* calf=knee* foot=ankle* ball=toes* clavicle=scapula* upperarm=shoulder* lowerarm=elbow* \
                hand=wrist* eye=eye* thumb_01=thumbfinger1* thumb_02=thumbfinger2* thumb_03=thumbfinger3* \
                index_01=indexfinger1* index_02=indexfinger2* index_03=indexfinger3* middle_01=middlefinger1* \
                middle_02=middlefinger2* middle_03=middlefinger3* ring_01=ringfinger1* ring_02=ringfinger2* \
                ring_03=ringfinger3* pinky_01=pinkyfinger1* pinky_02=pinkyfinger2* pinky_03=pinkyfinger3*",
    },
    VocabularyText {
        name: "MMD in English",
        sides: ["l", "r"],
        central: "pelvis=lowerbody|waist|groove|center spine_01=upperbody neck_01=neck head=head",
        sided: "thigh=leg* calf=knee* foot=ankle* ball=toe*|legex* clavicle=shoulder* upperarm=arm* lowerarm=elbow* \
                hand=wrist* eye=eye* thumb_01=thumb0* thumb_02=thumb1* thumb_03=thumb2* index_01=fore1*|index1* \
                index_02=fore2*|index2* index_03=fore3*|index3* middle_01=middle1* middle_02=middle2* \
                middle_03=middle3* ring_01=third1*|ring1* ring_02=third2*|ring2* ring_03=third3*|ring3* \
                pinky_01=little1* pinky_02=little2* pinky_03=little3*",
    },
    VocabularyText {
        name: "MMD",
        sides: ["左", "右"],
        central: "pelvis=下半身|腰|グルーブ|センター spine_01=上半身 neck_01=首 head=頭",
        sided: "thigh=*足|*足d calf=*ひざ|*ひざd|*膝 foot=*足首|*足首d ball=*足先ex|*つま先|*爪先 clavicle=*肩 upperarm=*腕 \
                lowerarm=*ひじ|*肘 hand=*手首 eye=*目 thumb_01=*親指0 thumb_02=*親指1 thumb_03=*親指2 index_01=*人指1|*人差指1 \
                index_02=*人指2|*人差指2 index_03=*人指3|*人差指3 middle_01=*中指1 middle_02=*中指2 middle_03=*中指3 \
                ring_01=*薬指1 ring_02=*薬指2 ring_03=*薬指3 pinky_01=*小指1 pinky_02=*小指2 pinky_03=*小指3",
    },
    VocabularyText {
        name: "MakeHuman",
        sides: ["l", "r"],
        central: "pelvis=root spine_01=spine05 neck_01=neck01 head=head jaw=jaw",
        sided: "thigh=upperleg01* calf=lowerleg01* foot=foot* ball=toe11* clavicle=clavicle* upperarm=upperarm01* \
                lowerarm=lowerarm01* hand=wrist* eye=eye* thumb_01=finger11* thumb_02=finger12* thumb_03=finger13* \
                index_01=finger21* index_02=finger22* index_03=finger23* middle_01=finger31* middle_02=finger32* \
                middle_03=finger33* ring_01=finger41* ring_02=finger42* ring_03=finger43* pinky_01=finger51* \
                pinky_02=finger52* pinky_03=finger53*",
    },
    VocabularyText {
        name: "Second Life",
        sides: ["left", "right"],
        central: "pelvis=mpelvis spine_01=mtorso spine_02=mchest neck_01=mneck head=mhead",
        sided: "thigh=mhip* calf=mknee* foot=mankle* ball=mfoot* clavicle=mcollar* upperarm=mshoulder* \
                lowerarm=melbow* hand=mwrist* eye=meye* thumb_01=mhandthumb1* thumb_02=mhandthumb2* \
                thumb_03=mhandthumb3* index_01=mhandindex1* index_02=mhandindex2* index_03=mhandindex3* \
                middle_01=mhandmiddle1* middle_02=mhandmiddle2* middle_03=mhandmiddle3* ring_01=mhandring1* \
                ring_02=mhandring2* ring_03=mhandring3* pinky_01=mhandpinky1* pinky_02=mhandpinky2* \
                pinky_03=mhandpinky3*",
    },
    VocabularyText {
        name: "Vicon",
        sides: ["left", "right"],
        central: "pelvis=pelvis|hips spine_01=lumbar|lowerback|spine spine_02=thorax|chest neck_01=neck head=head",
        sided: "thigh=*femur|*thigh|*hip calf=*tibia|*shin|*knee foot=*foot|*ankle ball=*toes|*toe \
                clavicle=*clavicle|*collar upperarm=*humerus|*uparm|*shoulder lowerarm=*radius|*lowarm|*elbow \
                hand=*hand|*wrist",
    },
    VocabularyText {
        name: "Kinect",
        sides: ["left", "right"],
        central: "pelvis=spinebase|hipcenter|pelvis spine_01=spinemid|spinenaval|spine neck_01=neck|spineshoulder \
                  head=head",
        sided: "thigh=hip* calf=knee* foot=ankle* ball=foot* clavicle=clavicle* upperarm=shoulder* lowerarm=elbow* \
                hand=wrist* hand_tip=handtip*|hand*",
    },
    VocabularyText {
        name: "ARKit",
        sides: ["left", "right"],
        central: "pelvis=hips spine_01=spine1 neck_01=neck1 head=head jaw=jaw",
        sided: "thigh=*upleg calf=*leg foot=*foot ball=*toes clavicle=*shoulder1 upperarm=*arm lowerarm=*forearm \
                hand=*hand eye=*eye thumb_01=*handthumb1 thumb_02=*handthumb2 thumb_03=*handthumbend \
                index_01=*handindex1 index_02=*handindex2 index_03=*handindex3 middle_01=*handmid1 \
                middle_02=*handmid2 middle_03=*handmid3 ring_01=*handring1 ring_02=*handring2 ring_03=*handring3 \
                pinky_01=*handpinky1 pinky_02=*handpinky2 pinky_03=*handpinky3",
    },
    VocabularyText {
        name: "Blender, by hand",
        sides: ["l", "r"],
        central: "pelvis=hips|hip|pelvis|root spine_01=spine|abdomen|torso spine_02=chest neck_01=neck head=head",
        sided: "thigh=upperleg*|upleg*|thigh*|uleg* calf=lowerleg*|lowleg*|calf*|shin*|lleg*|knee* \
                foot=foot*|ankle* ball=toe*|toes*|ball*|toebase* clavicle=clavicle*|clav*|collarbone*|collar*|shoulder* \
                upperarm=upperarm*|uparm*|bicep*|arm* lowerarm=lowerarm*|lowarm*|forearm*|elbow* \
                hand=hand*|wrist*|palm*",
    },
];
