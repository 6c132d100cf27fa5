using System;
using UnityEngine;

namespace Anthronet
{
    /// <summary>The skeleton of a character: its joints as transforms, named as in the rig. Main thread only.</summary>
    public sealed class AnthroRig
    {
        readonly Transform[] bones;
        readonly AnthroJoint[] joints;

        AnthroRig(Transform[] bones, AnthroJoint[] joints)
        {
            this.bones = bones;
            this.joints = joints;
        }

        /// <summary>The transforms, parents first; the first one is the root.</summary>
        public Transform[] Bones
        {
            get { return bones; }
        }

        /// <summary>The body's joints in the bind pose.</summary>
        public AnthroJoint[] Joints
        {
            get { return joints; }
        }

        /// <summary>Creates transforms for a body's joints, in the bind pose, as children of `parent`.</summary>
        public static AnthroRig Create(AnthroBody body, Transform parent)
        {
            var joints = body.Joints();
            var bones = new Transform[joints.Length];
            for (var i = 0; i < joints.Length; i++)
            {
                bones[i] = new GameObject(body.JointName(i)).transform;
                bones[i].SetParent(joints[i].parent < 0 ? parent : bones[joints[i].parent], false);
            }
            var rig = new AnthroRig(bones, joints);
            rig.ApplyBindPose();
            return rig;
        }

        /// <summary>Reuses existing transforms for a body's joints and sets them to its bind pose.</summary>
        /// <param name="body">The body.</param>
        /// <param name="root">The transform of the first joint; the others are below it.</param>
        /// <returns>Null if any joint is missing; nothing is changed then.</returns>
        internal static AnthroRig Adopt(AnthroBody body, Transform root)
        {
            var joints = body.Joints();
            var bones = new Transform[joints.Length];
            for (var i = 0; i < joints.Length; i++)
            {
                var parent = joints[i].parent;
                bones[i] = parent >= 0 ? bones[parent].Find(body.JointName(i)) : root;
                if (bones[i] == null || bones[i].name != body.JointName(i))
                {
                    return null;
                }
            }
            var rig = new AnthroRig(bones, joints);
            rig.ApplyBindPose();
            return rig;
        }

        /// <summary>The transform path of a joint below the character, as animation curves use it:
        /// `Root/pelvis/…`.</summary>
        public string Path(int joint)
        {
            var path = bones[joint].name;
            for (var parent = joints[joint].parent; parent >= 0; parent = joints[parent].parent)
            {
                path = bones[parent].name + "/" + path;
            }
            return path;
        }

        /// <summary>Sets the transforms to another body's bind pose.</summary>
        public void Update(AnthroBody body)
        {
            body.Joints(joints);
            ApplyBindPose();
        }

        /// <summary>Sets the transforms to the bind pose.</summary>
        public void ApplyBindPose()
        {
            for (var i = 0; i < bones.Length; i++)
            {
                bones[i].localPosition = joints[i].parentFromJoint.translation;
                bones[i].localRotation = joints[i].parentFromJoint.rotation;
            }
        }

        /// <summary>Sets the transforms to a pose relative to the parents. Allocates no managed memory.</summary>
        public void ApplyPose(AnthroTransform[] pose)
        {
            if (pose.Length != bones.Length)
            {
                throw new ArgumentException("expected " + bones.Length + " joints, got " + pose.Length, "pose");
            }
            for (var i = 0; i < bones.Length; i++)
            {
                bones[i].localPosition = pose[i].translation;
                bones[i].localRotation = pose[i].rotation;
            }
        }

        /// <summary>The index of a joint by its name in the rig; −1 where the rig has no such joint.</summary>
        public int IndexOf(string joint)
        {
            return Array.FindIndex(bones, bone => bone.name == joint);
        }

        /// <summary>The transform of a joint by its name in the rig; null where the rig has no such joint.</summary>
        public Transform Find(string joint)
        {
            return Array.Find(bones, bone => bone.name == joint);
        }
    }
}
